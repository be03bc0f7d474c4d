// The verification holds for the product and finds planted defects.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "runtime/verify/verify_page.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"

namespace brace {
namespace {

/// A defect in one of the product's functions and the group of claims that must find it.
struct Mutation {
  std::string name;
  std::string group;
  std::function<void(VerifySubjects&)> plant;
};

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

/// Hands every cast on with another rule.
std::function<void(VerifySubjects&)> with_rule(std::function<void(CastCase&)> change) {
  return [change](VerifySubjects& subjects) {
    subjects.cast = [cast = subjects.cast, change](CastCase wanted) {
      change(wanted);
      return cast(wanted);
    };
  };
}

std::function<void(VerifySubjects&)> with_result(std::function<void(const CastCase&, CastResult&)> spoil) {
  return [spoil](VerifySubjects& subjects) {
    subjects.cast = [cast = subjects.cast, spoil](const CastCase& wanted) {
      CastResult result = cast(wanted);
      spoil(wanted, result);
      return result;
    };
  };
}

const std::vector<Mutation>& mutations() {
  static const std::vector<Mutation> all = {
      // Integrators.
      {"midpoint samples at the left", "integrators", with_rule([](CastCase& c) {
         if (c.rule.integrator == "midpoint-exponential") c.rule.integrator = "left";
       })},
      {"linear source takes the middle's colour", "integrators", with_rule([](CastCase& c) {
         if (c.rule.integrator == "linear-source") c.rule.integrator = "midpoint-exponential";
       })},
      {"pre-integration samples", "integrators", with_rule([](CastCase& c) {
         if (c.rule.integrator == "pre-integrated") c.rule.integrator = "midpoint-exponential";
       })},
      {"absorption 2 % too strong", "integrators", with_rule([](CastCase& c) {
         for (auto& entry : c.table.entries)
           entry[3] *= 1.02;
       })},
      {"last segment not cut at the exit", "integrators", with_rule([](CastCase& c) {
         for (CastRay& ray : c.rays)
           ray.entry.w += 0.25f;
       })},
      {"colour clamped to 8 bits", "integrators", with_result([](const CastCase&, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           colour = glm::round(colour * 255.0f) / 255.0f;
       })},
      // Adaptive steps.
      {"tolerance ignored", "adaptive", with_rule([](CastCase& c) {
         if (c.rule.tolerance > 0) c.rule.tolerance = 0.5;
       })},
      {"always the smallest steps", "adaptive", with_rule([](CastCase& c) {
         if (c.rule.tolerance > 0) c.rule.tolerance = 1e-4;
       })},
      // Stability.
      {"explicit Euler instead of the exponential", "stability",
       [](VerifySubjects& s) {
         s.run_stability = [run = s.run_stability](StabilityRule rule, Precision p, double x) {
           return run(rule == StabilityRule::exponential_midpoint ? StabilityRule::euler : rule, p, x);
         };
       }},
      {"halves where singles are claimed", "stability",
       [](VerifySubjects& s) {
         s.run_stability = [run = s.run_stability](StabilityRule rule, Precision, double x) {
           return run(rule, Precision::fp16, x);
         };
       }},
      {"0/0 in the thinnest medium", "stability", with_result([](const CastCase& c, CastResult& r) {
         if (c.rule.integrator == "linear-source") r.colours.front().r = NAN;
       })},
      {"overflow in the densest medium", "stability", with_result([](const CastCase& c, CastResult& r) {
         if (c.rule.integrator == "pre-integrated") r.colours.back().a = INFINITY;
       })},
      {"colour above the opacity", "stability", with_result([](const CastCase&, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           colour.r *= 1.01f;
       })},
      // Absorption.
      {"opacity correction by ρα", "absorption",
       [](VerifySubjects& s) {
         s.opacity_corrected = [](double alpha, double rho) { return std::min(1.0, alpha * rho); };
       }},
      {"opacity correction without log1p", "absorption",
       [](VerifySubjects& s) {
         s.opacity_corrected = [](double alpha, double rho) {
           return rho == 0 ? 0 : 1 - std::exp(rho * std::log(1 - alpha));
         };
       }},
      {"the thesis' Algorithm 6: κ without the logarithm", "absorption",
       [](VerifySubjects& s) {
         s.kappa_from_opacity = [](double opacity, double length) { return opacity / length; };
       }},
      {"1 − exp in place of expm1", "absorption",
       [](VerifySubjects& s) {
         s.opacity_from_kappa = [](double kappa, double length) { return 1 - std::exp(-kappa * length); };
       }},
      {"optical depth summed as opacity", "absorption",
       [](VerifySubjects& s) {
         s.accumulate = [run = s.accumulate](Accumulator a, Precision p, double alpha, int n) {
           return run(a == Accumulator::optical_depth ? Accumulator::opacity : a, p, alpha, n);
         };
       }},
      {"halves rounded as singles", "absorption",
       [](VerifySubjects& s) {
         s.accumulate = [run = s.accumulate](Accumulator a, Precision p, double alpha, int n) {
           return run(a, p == Precision::fp16 ? Precision::fp32 : p, alpha, n);
         };
       }},
      {"transfer integrals by the left rule", "absorption",
       [](VerifySubjects& s) {
         s.integrate = [](const TransferTable& table, double step) {
           TransferIntegrals sums(table.entries.size());
           for (std::size_t i = 1; i < sums.size(); ++i) {
             sums[i] = sums[i - 1];
             const auto& entry = table.entries[i - 1];
             for (std::size_t c = 0; c < 4; ++c)
               sums[i][c] += entry[3] * step / std::log(2.0) * (c < 3 ? entry[c] : 1);
           }
           return sums;
         };
       }},
      {"a ray forgets its first sample", "absorption", with_rule([](CastCase& c) {
         for (CastRay& ray : c.rays)
           ray.entry.w -= 0.01f;
       })},
      // Skipping.
      {"occupancy by the presence of voxel values", "skipping",
       with_rule([](CastCase& c) { c.occupancy = Occupancy::voxel; })},
      {"rays end a step early behind empty space", "skipping", with_rule([](CastCase& c) {
         if (c.skip == SkipKind::none) return;
         for (CastRay& ray : c.rays)
           ray.entry.w *= 0.5f;
       })},
      {"one bit in one ray", "skipping", with_result([](const CastCase& c, CastResult& r) {
         if (c.skip == SkipKind::octree) r.colours[100].g = std::nextafter(r.colours[100].g, 1.0f);
       })},
      {"nothing is skipped", "skipping", with_rule([](CastCase& c) { c.skip = SkipKind::none; })},
      // Extreme scenes.
      {"not a number where nothing is visible", "extremes", with_result([](const CastCase& c, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           if (colour.a == 0.0f && c.rule.integrator == "left") colour.g = NAN;
       })},
      {"opaque is not quite opaque", "extremes", with_result([](const CastCase&, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           colour *= 0.99f;
       })},
      // Lenses.
      {"inverse by three steps of a fixed point", "lenses",
       [](VerifySubjects& s) {
         s.lens_inverse = [](sim::LensKind kind, const std::array<double, 5>& k, double source, double,
                             int* n) {
           double r = source;
           for (int i = 0; i < 3; ++i)
             r = source / sim::lens_scale(kind, k, r);
           if (n != nullptr) *n = 3;
           return std::optional<double>(r);
         };
       }},
      {"fold-over 2 % too far out", "lenses",
       [](VerifySubjects& s) {
         s.fold_over_radius = [](sim::LensKind kind, const std::array<double, 5>& k, double r_max) {
           return std::min(r_max, 1.02 * sim::fold_over_radius(kind, k, r_max));
         };
       }},
      {"inverse from beyond the fold", "lenses",
       [](VerifySubjects& s) {
         s.lens_inverse = [](sim::LensKind kind, const std::array<double, 5>& k, double source, double usable,
                             int* n) {
           const auto found = sim::lens_inverse(kind, k, source, usable, n);
           return found ? found : std::optional<double>(usable);
         };
       }},
      // Motion.
      {"logarithm by acos", "motion",
       [](VerifySubjects& s) {
         s.quat_log = [](const glm::dquat& q) {
           const double half = std::acos(std::min(1.0, std::abs(q.w)));
           const glm::dvec3 axis(q.x, q.y, q.z);
           const double sine = glm::length(axis);
           return sine > 0 ? axis * (2 * half / sine * (q.w < 0 ? -1 : 1)) : axis;
         };
       }},
      {"logarithm without the hemisphere", "motion",
       [](VerifySubjects& s) {
         s.quat_log = [](const glm::dquat& q) {
           const glm::dvec3 axis(q.x, q.y, q.z);
           const double sine = glm::length(axis);
           return sine > 0 ? axis * (2 * std::atan2(sine, q.w) / sine) : axis;
         };
       }},
      {"exponential with half the angle forgotten", "motion",
       [](VerifySubjects& s) { s.quat_exp = [](const glm::dvec3& v) { return quat_exp(2.0 * v); }; }},
      {"Hermite is slerp", "motion",
       [](VerifySubjects& s) {
         s.pose_at = [](const sim::PoseTrace& trace, SimTime time, sim::Interpolation) {
           return trace.at(time, sim::Interpolation::slerp_linear);
         };
       }},
      {"resampling takes the nearest pose before", "motion",
       [](VerifySubjects& s) {
         s.pose_at = [](const sim::PoseTrace& trace, SimTime time, sim::Interpolation) {
           const auto& poses = trace.poses();
           const auto after =
               std::upper_bound(poses.begin(), poses.end(), time,
                                [](SimTime t, const sim::TimedPose& pose) { return t < pose.time; });
           return (after == poses.begin() ? poses.front() : *(after - 1)).world_from_head;
         };
       }},
      {"a broken pose is read as it is", "motion",
       [](VerifySubjects& s) {
         s.parse_trace = [](const std::string& text, const std::string& name) {
           auto read = sim::parse_trace(text, name);
           read.repairs.dropped_bad_quaternion = 0;
           ++read.repairs.poses_kept;
           return read;
         };
       }},
      {"vsyncs by a truncated period", "motion",
       [](VerifySubjects& s) {
         s.vsync_time = [](const sim::VsyncClock& clock, std::int64_t index) {
           return clock.epoch() + SimDuration(index * (1'000'000'000 * clock.rate().den / clock.rate().num));
         };
       }},
      {"SSIM with K1 = 0.03", "motion",
       [](VerifySubjects& s) {
         s.ssim = [](const ImageRgba8& a, const ImageRgba8& b) {
           const double x = a.pixels[0].r, y = b.pixels[0].r, c = std::pow(0.03 * 255, 2);
           return (2 * x * y + c) / (x * x + y * y + c);
         };
       }},
      // Stereo.
      {"one layer short: the fencepost", "stereo",
       [](VerifySubjects& s) {
         s.layer_count = [](const StereoOptics& optics, double radius_m, double near_m) {
           return layer_count(optics, radius_m, near_m) - 1;
         };
       }},
      {"near plane by the difference of two large numbers", "stereo",
       [](VerifySubjects& s) {
         s.near_plane_m = [](const StereoOptics& optics, double radius_m, double disparity_px) {
           const double q = 2 * optics.eye_distance_m * optics.pixels_per_tangent * radius_m / disparity_px;
           return -radius_m + std::sqrt(radius_m * radius_m + q);
         };
       }},
      {"disparity of a sphere by cancelling quotients", "stereo",
       [](VerifySubjects& s) {
         s.disparity_range_of_sphere_px = [](const StereoOptics& optics, double radius_m, double near_m) {
           return disparity_range_px(optics, near_m, near_m + 2 * radius_m);
         };
       }},
      {"layers for a range without its fraction", "stereo",
       [](VerifySubjects& s) {
         s.interference_free_layers = [](double range_px, double) { return static_cast<int>(range_px) + 1; };
       }},
      {"path lengths of the first eye for the second", "stereo",
       [](VerifySubjects& s) {
         s.compose_scan_line = [](const StereoGeometry& geometry, const ScanRow& row, int width_px,
                                  const PathLengths&) { return compose_scan_line(geometry, row, width_px); };
       }},
      {"eyes the wrong way round", "stereo",
       [](VerifySubjects& s) {
         s.compose_scan_line = [](StereoGeometry geometry, const ScanRow& row, int width_px,
                                  const PathLengths& lengths) {
           geometry.shift_px -= 20.0;
           return compose_scan_line(geometry, row, width_px, lengths);
         };
       }},
      // Control.
      {"stability of a frame less of delay", "control",
       [](VerifySubjects& s) {
         s.pi_control_is_stable = [](double p, double i, std::uint32_t delay) {
           return stages::pi_control_is_stable(p, i, delay == 0 ? 0 : delay - 1);
         };
       }},
      {"a miss takes a fixed step", "control",
       [](VerifySubjects& s) {
         s.quantile_control = [make = s.quantile_control](bool) { return make(false); };
       }},
      {"a miss takes half", "control",
       [](VerifySubjects& s) {
         s.quantile_control = [make = s.quantile_control](bool) {
           return [update = make(false), n = 0](const stages::FrameLoad& load) mutable {
             return load.missed && ++n % 2 == 0 ? update({0.5, false}) : update(load);
           };
         };
       }},
      {"quality that is never given back", "control",
       [](VerifySubjects& s) {
         s.quantile_control = [make = s.quantile_control](bool cut) {
           return [update = make(cut), least = 1.0](const stages::FrameLoad& load) mutable {
             return least = std::min(least, update(load));
           };
         };
       }},
      {"integral part that winds up", "control",
       [](VerifySubjects& s) {
         s.pi_control = [] {
           return [u = 0.0](const stages::FrameLoad& load) mutable {
             u -= 0.3 * std::log(std::clamp(load.cost, 1e-13, 1e13) / 0.85);
             return std::clamp(std::exp(u), 0.05, 1.0);
           };
         };
       }},
      {"not a number from a cost of nothing", "control",
       [](VerifySubjects& s) {
         s.window_control = [make = s.window_control] {
           return [update = make()](const stages::FrameLoad& load) {
             return load.cost == 0.0 ? std::nan("") : update(load);
           };
         };
       }},
      // Schedule.
      {"every prediction is zero", "schedule",
       [](VerifySubjects& s) {
         s.cell_schedule = [make = s.cell_schedule](const ChunkedParams& params) {
           CellFunctions cells = make(params);
           cells.next = [next = cells.next_in_any_case](SimDuration) { return next(); };
           return cells;
         };
       }},
      {"a load step is not learned from", "schedule",
       [](VerifySubjects& s) {
         s.cell_schedule = [make = s.cell_schedule](const ChunkedParams& params) {
           CellFunctions cells = make(params);
           cells.trace = [trace = cells.trace](const CellSchedule::Cell& cell, SimDuration cost) {
             trace({cell.number, cost}, cost / 10);
           };
           return cells;
         };
       }},
      {"the last cell is left out", "schedule",
       [](VerifySubjects& s) {
         s.cell_schedule = [make = s.cell_schedule](const ChunkedParams& params) {
           CellFunctions cells = make(params);
           cells.left = [left = cells.left] { return left() - 1; };
           return cells;
         };
       }},
  };
  return all;
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

TEST_F(Verify, FindsEveryPlantedDefect) {
  EXPECT_GE(mutations().size(), 50u);
  for (const Mutation& mutation : mutations()) {
    VerifySubjects defective = subjects();
    mutation.plant(defective);
    VerifyFigures figures;
    const auto claims = check(mutation.group, defective, figures);
    EXPECT_TRUE(std::any_of(claims.begin(), claims.end(), [](const Claim& claim) { return !claim.passed; }))
        << mutation.name << " was not found by group " << mutation.group;
  }
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
  EXPECT_TRUE(std::isnan(largest.value()) || largest.value() == 2.0);
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
