// The verification holds for the product and finds planted defects.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "runtime/verify/verify_page.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"
#include "tests/unit/verify/planted_defects.hpp"

namespace brace {
namespace {

std::vector<Claim> check(const std::string& group, const VerifySubjects& subjects, VerifyFigures& figures) {
  for (const VerifyGroup& known : verify_groups()) {
    if (known.name != group) continue;
    Claims claims(group);
    known.check(subjects, claims, figures);
    return claims.take();
  }
  ADD_FAILURE() << "no group " << group;
  return {};
}

class Verify : public gpu::GpuTest {
 protected:
  static void TearDownTestSuite() {
    caster_.reset();
    remembered_.clear();
    gpu::GpuTest::TearDownTestSuite();
  }

  /// The product's functions; a cast that was done once is remembered, so that a defect elsewhere costs
  /// nothing.
  VerifySubjects subjects() {
    const std::filesystem::path data = BRACE_DATA_FOLDER;
    if (caster_ == nullptr) caster_ = std::make_unique<Caster>(device(), data);
    VerifySubjects product = product_subjects(*caster_, data);
    product.cast = [cast = product.cast](const CastCase& wanted) {
      std::string key =
          fmt::format("{} {} {} {} {} {}", static_cast<const void*>(wanted.volume), wanted.rule.name(),
                      wanted.rule.step_voxels, static_cast<int>(wanted.skip),
                      static_cast<int>(wanted.occupancy), wanted.rays.size());
      double sum = 0;
      for (std::size_t i = 0; i < wanted.table.entries.size(); ++i)
        sum += wanted.table.entries[i][3] * static_cast<double>(i + 1) + wanted.table.entries[i][0];
      for (const CastRay& ray : wanted.rays)
        sum = 1.1 * sum + static_cast<double>(ray.entry.x + ray.entry.y + ray.entry.w);
      key += fmt::format(" {}", sum);
      const auto found = remembered_.find(key);
      return found != remembered_.end() ? found->second
                                        : remembered_.emplace(key, cast(wanted)).first->second;
    };
    return product;
  }

 private:
  static inline std::unique_ptr<Caster> caster_;
  static inline std::map<std::string, CastResult> remembered_;
};

TEST_F(Verify, HoldsForTheProductAndWritesItsPage) {
  VerifyReport report;
  report.device = "a <device>";
  report.version = "1";
  for (const VerifyGroup& group : verify_groups()) {
    for (Claim& claim : check(group.name, subjects(), report.figures)) {
      EXPECT_TRUE(claim.passed) << group.name << ": " << claim.claim << ": " << claim.figure << ", bound "
                                << to_string(claim.bound);
      report.claims.push_back(std::move(claim));
    }
  }
  EXPECT_GE(report.claims.size(), 130u);
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_TRUE(json["passed"].get<bool>());
  EXPECT_EQ(json["claims"].size(), report.claims.size());

  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "brace_verify_report.html";
  write_verify_page(path, report, std::filesystem::path(BRACE_DATA_FOLDER) / "report");
  std::ifstream stream(path);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_THAT(page, testing::HasSubstr("a &lt;device>"));
  EXPECT_THAT(page, testing::HasSubstr("κΔt"));
  EXPECT_THAT(page, testing::Not(testing::HasSubstr("nan")));
  std::filesystem::remove(path);
}

std::vector<PlantedDefect> planted_defects() {
  std::vector<PlantedDefect> all;
  for (const auto& part : {defects_in_casts(), defects_in_numbers(), defects_in_stereo_and_control()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

TEST_F(Verify, FindsEveryPlantedDefectAndEveryClaimFindsOne) {
  std::map<std::string, std::set<std::string>> never_failed;
  std::size_t claimed = 0;
  for (const VerifyGroup& group : verify_groups()) {
    VerifyFigures figures;
    for (const Claim& claim : check(group.name, subjects(), figures)) {
      EXPECT_TRUE(never_failed[group.name].insert(claim.claim).second) << "claimed twice: " << claim.claim;
      ++claimed;
    }
  }
  EXPECT_GE(claimed, 180u);
  for (const PlantedDefect& defect : planted_defects()) {
    VerifySubjects defective = subjects();
    defect.plant(defective);
    VerifyFigures figures;
    int found = 0;
    for (const Claim& claim : check(defect.group, defective, figures)) {
      if (claim.passed) continue;
      ++found;
      never_failed[defect.group].erase(claim.claim);
    }
    EXPECT_GT(found, 0) << defect.name << " was not found by group " << defect.group;
  }
  for (const auto& [group, claims] : never_failed)
    for (const std::string& claim : claims)
      ADD_FAILURE() << group << ": no planted defect fails the claim: " << claim;
}

TEST(ClaimTest, NaNNeverPasses) {
  Claims claims("group");
  claims.add("a", NAN, {});
  claims.add("b", 1.0, at_most(1.0));
  claims.add("c", 1.1, at_most(1.0));
  const auto list = claims.take();
  EXPECT_FALSE(list[0].passed);
  EXPECT_TRUE(list[1].passed);
  EXPECT_FALSE(list[2].passed);
  Largest largest;
  largest.see(1.0);
  largest.see(NAN);
  largest.see(2.0);
  EXPECT_TRUE(std::isnan(largest.value())) << "a larger number after it hides no NaN";
}

TEST(Precision, HalvesRoundToNearestEven) {
  EXPECT_EQ(rounded(1.0 + 1.0 / 2048, Precision::fp16), 1.0);
  EXPECT_EQ(rounded(1.0 + 3.0 / 2048, Precision::fp16), 1.0 + 2.0 / 1024);
  EXPECT_EQ(rounded(65504, Precision::fp16), 65504);
  EXPECT_EQ(rounded(65520, Precision::fp16), INFINITY);
  EXPECT_EQ(rounded(6e-8, Precision::fp16), std::ldexp(1, -24));
  EXPECT_EQ(rounded(2e-8, Precision::fp16), 0.0);
  EXPECT_EQ(rounded(1e300, Precision::fp32), INFINITY);
}

}  // namespace
}  // namespace brace
