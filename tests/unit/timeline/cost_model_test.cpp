#include "runtime/timeline/cost_model.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

const std::filesystem::path models = std::filesystem::path(BRACE_SOURCE_DIR) / "runtime/costs";

std::string error_of(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "broken.toml";
  std::ofstream(file) << text;
  std::string message;
  try {
    read_cost_model(file);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    message = error.what();
  }
  std::filesystem::remove(file);
  EXPECT_THAT(message, HasSubstr("broken.toml"));
  return message;
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t place = text.find(what);
  EXPECT_NE(place, std::string::npos) << what;
  return text.replace(place, what.size(), with);
}

double ms(const CostModel& model, JobKind kind, const WorkCounts& work) {
  return static_cast<double>(evaluate(model, kind, work).count()) * 1e-6;
}

TEST(CostModels, TheShippedOnesAreThoseOfTheContract) {
  EXPECT_THAT(cost_model_names(models),
              testing::ElementsAre("gtx-1080", "lavapipe-2core", "rtx-2060m", "rtx-2070", "rtx-4090"));
  for (const std::string& name : cost_model_names(models)) {
    const CostModel model = find_cost_model(models, name);
    EXPECT_EQ(model.name, name);
    EXPECT_FALSE(model.summary.empty());
    EXPECT_GT(model.item_ns.sample, 0) << name;
  }
}

TEST(CostModels, AnUnknownNameGetsTheNearestOne) {
  try {
    find_cost_model(models, "gtx-1008");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'gtx-1080'"));
    EXPECT_THAT(error.what(), HasSubstr("rtx-4090"));
  }
  EXPECT_THROW(find_cost_model(models / "nowhere", "gtx-1080"), Error);
}

TEST(CostModels, FilesRoundTripThroughText) {
  const CostModel model = find_cost_model(models, "gtx-1080");
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "gtx-1080.toml";
  std::ofstream(file) << to_toml(model);
  const CostModel again = read_cost_model(file);
  std::filesystem::remove(file);
  EXPECT_EQ(again.base_ns, model.base_ns);
  EXPECT_EQ(again.item_ns, model.item_ns);
  EXPECT_EQ(again.summary, model.summary);
}

TEST(CostModels, BadFilesAreNamedWithKeyAndWhatIsAccepted) {
  const std::string good = to_toml({.name = "broken", .summary = "s", .base_ns = {}, .item_ns = {}});
  EXPECT_THAT(error_of(replaced(good, "sample =", "sampel =")), HasSubstr("did you mean 'sample'"));
  EXPECT_THAT(error_of(replaced(good, "texel = 0\n", "")), HasSubstr("item_ns.texel is missing"));
  EXPECT_THAT(error_of(replaced(good, "warp = 0", "warp = -1")), HasSubstr("base_ns.warp must be"));
  EXPECT_THAT(error_of(replaced(good, "warp = 0", "warp = nan")), HasSubstr("base_ns.warp must be"));
  EXPECT_THAT(error_of(replaced(good, "warp = 0", "warp = 'dear'")), HasSubstr("base_ns.warp must be"));
  EXPECT_THAT(error_of(replaced(good, "\"broken\"", "\"other\"")), HasSubstr("must equal the file's name"));
  EXPECT_THAT(error_of(replaced(good, "[base_ns]", "[bases_ns]")), HasSubstr("did you mean 'base_ns'"));
  EXPECT_THAT(error_of("name = "), HasSubstr("broken.toml:1"));
}

// Thesis, 6.1.2. The counts are those that runtime/costs/gtx-1080.toml derives; half of base_ns.cast is one
// eye's.
TEST(CostModels, Gtx1080ReproducesTheThesisTimings) {
  const CostModel model = find_cost_model(models, "gtx-1080");
  const auto eye_ms = [&](double samples, double fetches_per_shaded_sample) {
    const double taken = 0.8 * samples;
    const WorkCounts work{
        .samples = static_cast<std::uint64_t>(taken),
        .shading_fetches = static_cast<std::uint64_t>(0.3 * fetches_per_shaded_sample * taken)};
    return ms(model, JobKind::cast, work) - 0.5e-6 * model.base_ns.cast;
  };
  const double visible_male = 10.75 / (2 - 0.102);
  EXPECT_NEAR(eye_ms(20.017e6, 4), visible_male, 0.02);
  const double second_eye = (10.75 - visible_male - 1.65) * 9.244 / 20.017;
  EXPECT_NEAR(eye_ms(9.244e6, 38), 7.91 - 1.65 - second_eye, 0.02);
  const WorkCounts clearing{.bytes = 2 * 768ULL * 768 * 32 * 8};
  EXPECT_NEAR(ms(model, JobKind::update, clearing) - 1e-6 * model.base_ns.update, 1.65, 0.01);
}

std::vector<std::vector<std::string>> reference_table(const char* name) {
  const char* shared = std::getenv("BRACE_SHARED_DIR");
  const std::filesystem::path folder = shared != nullptr
                                           ? std::filesystem::path(shared)
                                           : std::filesystem::path(BRACE_SOURCE_DIR) / "../shared";
  std::ifstream file(folder / "reference" / name);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');)
      rows.back().push_back(cell);
  }
  return rows;
}

TEST(CostModels, RtxBaselinesReproduceTheMeanOfThePublishedBaselineFrameTimes) {
  const auto rows = reference_table("mab_table1.csv");
  if (rows.empty()) GTEST_SKIP() << "no mab_table1.csv: set BRACE_SHARED_DIR";
  const auto samples = static_cast<std::uint64_t>(2560 * 1440 * 0.5 * 512 * 0.1);
  for (const auto& [gpu, name] : {std::pair("RTX 2070", "rtx-2070"), std::pair("RTX 2060m", "rtx-2060m")}) {
    double sum_ms = 0;
    for (const auto& row : rows) {
      if (row[2] == "baseline" && row[3] == gpu) sum_ms += 1000 / std::stod(row[5]);
    }
    const double model_ms =
        ms(find_cost_model(models, name), JobKind::cast, {.samples = samples, .skip_steps = samples});
    EXPECT_NEAR(model_ms, sum_ms / 2, 0.02 * sum_ms / 2) << name;
  }
}

TEST(CostModels, Rtx4090UpdatePricesAreTheFitOfThePublishedMergeTimes) {
  const auto rows = reference_table("pdm_table1.csv");
  if (rows.empty()) GTEST_SKIP() << "no pdm_table1.csv: set BRACE_SHARED_DIR";
  std::vector<CostSample> samples;
  for (const auto& row : rows) {
    const bool all = row[3] == "TF1" || row[3] == "TF2";
    const bool half = row[3] == "TF3" || row[3] == "TF4";
    if (row[2] != "update_ms" || !(all || half)) continue;
    std::uint64_t blocks = 1;
    std::istringstream dims(row[1]);
    for (std::string edge; std::getline(dims, edge, 'x');)
      blocks *= (std::stoull(edge) + 3) / 4;
    for (std::uint64_t column = 0; column < 5; ++column) {
      const std::uint64_t maps = (16ULL << column) / (all ? 1 : 2);
      const std::uint64_t passes = (maps + 5) / 6;
      samples.push_back({.kind = JobKind::update,
                         .work = {.bytes = blocks * (maps + 2 * passes - 1)},
                         .time = from_s(std::stod(row[5 + column]) * 1e-3)});
    }
  }
  ASSERT_EQ(samples.size(), 60U);
  const CostFit fit = fit_cost_model(samples, "fit");
  const CostModel model = find_cost_model(models, "rtx-4090");
  EXPECT_NEAR(model.base_ns.update, fit.model.base_ns.update, 0.005 * fit.model.base_ns.update);
  EXPECT_NEAR(model.item_ns.byte, fit.model.item_ns.byte, 0.005 * fit.model.item_ns.byte);
  EXPECT_NEAR(fit.rms_relative_error, 0.14, 0.005) << "as the file says";
}

}  // namespace
}  // namespace brace
