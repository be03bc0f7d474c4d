// Equal sessions give equal bytes, whatever the folder, the number of threads, and who pays attention.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::quick_session;
using test::RunOptions;
using test::Workplace;
using testing::HasSubstr;

/// A driver list with no driver in it: anything that wants Vulkan fails.
const RunOptions no_vulkan = {{{"VK_ICD_FILENAMES", "/dev/null"}, {"VK_DRIVER_FILES", "/dev/null"}}};

void expect_done(const Outcome& outcome) {
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

std::string summary_without_host(const Workplace& place, const std::string& run) {
  auto summary = nlohmann::ordered_json::parse(place.read(run + "/summary.json"));
  EXPECT_EQ(summary.erase("host"), 1U);
  return summary.dump();
}

void expect_same_run(const Workplace& place, const std::string& a, const std::string& b) {
  EXPECT_EQ(place.read(a + "/frames.csv"), place.read(b + "/frames.csv"));
  EXPECT_EQ(place.read(a + "/costs.csv"), place.read(b + "/costs.csv"));
  EXPECT_EQ(summary_without_host(place, a), summary_without_host(place, b));
}

TEST(CliDeterminism, ModelCostsGiveTheSameBytesInAnyFolderWithAnyNumberOfThreads) {
  Workplace place;
  place.write("s.toml", quick_session());
  const std::vector<std::string> with_pictures = {"--set", "output.error=every:4", "--set",
                                                  "output.images=ends"};
  const auto run = [&](const std::string& out, const RunOptions& options) {
    std::vector<std::string> arguments = {"run", "s.toml", "--out", out};
    arguments.insert(arguments.end(), with_pictures.begin(), with_pictures.end());
    expect_done(place.brace(arguments, options));
  };
  run("a", {});
  run("deeper/b", {{{"LP_NUM_THREADS", "1"}}});
  run("c", {{{"LP_NUM_THREADS", "2"}}});
  expect_same_run(place, "a", "deeper/b");
  expect_same_run(place, "a", "c");
  EXPECT_EQ(place.read("a/session.toml"), place.read("c/session.toml"));
  EXPECT_EQ(place.read("a/images/000009_left.png"), place.read("c/images/000009_left.png"));
  EXPECT_THAT(place.read("a/summary.json"), HasSubstr("\"deterministic\": true"));
}

TEST(CliDeterminism, PacingOnlyRunsAreTheSameToo) {
  Workplace place;
  place.write("s.toml", quick_session());
  expect_done(place.brace({"run", "s.toml", "--out", "a"}));
  expect_done(place.brace({"run", "s.toml", "--out", "a"}));  // over the first one
  expect_done(place.brace({"run", "s.toml", "--out", "b"}));
  expect_same_run(place, "a", "b");
}

TEST(CliDeterminism, AnotherSeedIsAnotherRun) {
  Workplace place;
  place.write("s.toml", quick_session());
  expect_done(place.brace({"run", "s.toml", "--out", "a"}));
  expect_done(place.brace({"run", "s.toml", "--out", "b", "--seed", "2"}));
  EXPECT_NE(place.read("a/frames.csv"), place.read("b/frames.csv"));
}

TEST(CliDeterminism, RecordedCostsReproduceTheRunTheyCameFrom) {
  Workplace place;
  place.write("s.toml", quick_session());
  expect_done(place.brace({"run", "s.toml", "--out", "a"}));
  expect_done(place.brace({"run", "s.toml", "--out", "b", "--set", "clock.cost=recorded:a"}));
  expect_done(place.brace({"run", "s.toml", "--out", "c", "--set", "clock.cost=recorded:b"}));
  EXPECT_EQ(place.read("b/costs.csv"), place.read("a/costs.csv"));
  expect_same_run(place, "b", "c");
}

TEST(CliDeterminism, RecordedCostsOfARunWithPicturesGiveTheSameFrames) {
  Workplace place;
  place.write("s.toml", quick_session());
  for (const char* cost : {"model:gtx-1080", "recorded:model_gtx-1080"}) {
    const std::string out = cost[0] == 'm' ? "model_gtx-1080" : "again";
    expect_done(place.brace({"run", "s.toml", "--out", out, "--set", std::string("clock.cost=") + cost,
                             "--set", "output.error=every:3"}));
  }
  EXPECT_EQ(place.read("again/frames.csv"), place.read("model_gtx-1080/frames.csv"));
}

TEST(CliDeterminism, ARunMayBeRepeatedFromItsOwnResolvedSession) {
  Workplace place;
  place.write("sessions/s.toml", quick_session());
  expect_done(place.brace({"run", "sessions/s.toml", "--out", "a", "--set", "run.seed=5"}));
  expect_done(place.brace({"run", "a/session.toml", "--out", "b"}));
  expect_same_run(place, "a", "b");
  EXPECT_EQ(place.read("a/session.toml"), place.read("b/session.toml"));
}

TEST(CliDeterminism, ComparisonsMayBeRunAgainIntoTheSameFolder) {
  Workplace place;
  place.write("s.toml", quick_session() + "[compare]\nkey = 'pipeline.warp'\nvalues = ['none', 'quad']\n");
  for (int i = 0; i < 2; ++i) {
    expect_done(place.brace({"run", "s.toml", "--out", "a", "--set", "output.images=list:3"}));
  }
  EXPECT_NE(place.read("a/frames.csv"), place.read("a/frames-quad.csv"));
  EXPECT_TRUE(std::filesystem::exists(place / "a/images-quad/000003_left.png"));
}

TEST(CliDeterminism, LabelsOfAComparisonCannotLeaveTheRunDirectory) {
  Workplace place;
  place.write("s.toml", quick_session() +
                            "[compare]\nkey = 'trace.file'\nvalues = ['x/../../up.trace', "
                            "'x/../../../other.trace']\n");
  place.write("traces.txt", "");
  std::string session = place.read("s.toml");
  const std::size_t neck = session.find("neck =");
  session.replace(neck, session.find('\n', neck) - neck, "file = 'x'");
  place.write("deep/er/s.toml", session);
  for (const char* name : {"deep/up.trace", "other.trace"}) {
    expect_done(place.brace({"trace", "generate", "rotation", name, "--seconds", "0.3"}));
  }
  expect_done(place.brace({"run", "deep/er/s.toml", "--out", "runs/a", "--set", "output.images=list:3"}));
  EXPECT_THAT(place.names(), testing::ElementsAre("deep", "other.trace", "runs", "s.toml", "traces.txt"));
  int runs = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(place / "runs"))
    ++runs;
  EXPECT_EQ(runs, 1);
}

TEST(CliNoDevice, ScriptedCostsWithoutPicturesNeedNoVulkan) {
  Workplace place;
  place.write("s.toml", quick_session() + "[[clock.script]]\nfrom_s = 0\ncast_ms = 14\nwarp_ms = 1\n");
  expect_done(place.brace({"run", "s.toml", "--out", "a", "--set", "clock.cost=scripted"}, no_vulkan));
  const auto summary = nlohmann::json::parse(place.read("a/summary.json"));
  EXPECT_EQ(summary["vsyncs"], 10);
  EXPECT_TRUE(summary["deterministic"].get<bool>());
}

TEST(CliNoDevice, ARunWithoutAnyEyeFrameInTimeSaysSo) {
  Workplace place;
  for (const auto& [cast_ms, says] : {std::pair{14, false}, std::pair{1400, true}}) {
    place.write(
        "s.toml",
        quick_session() + fmt::format("[[clock.script]]\nfrom_s = 0\ncast_ms = {}\nwarp_ms = 1\n", cast_ms));
    const Outcome outcome =
        place.brace({"run", "s.toml", "--out", "a", "--set", "clock.cost=scripted"}, no_vulkan);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out.find("nothing was shown") != std::string::npos, says) << outcome.out;
  }
}

TEST(CliNoDevice, RecordedCostsWithoutPicturesNeedNoVulkan) {
  Workplace place;
  place.write("s.toml", quick_session());
  expect_done(place.brace({"run", "s.toml", "--out", "a"}));
  expect_done(place.brace({"run", "s.toml", "--out", "b", "--set", "clock.cost=recorded:a"}, no_vulkan));
  EXPECT_EQ(place.read("a/costs.csv"), place.read("b/costs.csv"));
}

}  // namespace
}  // namespace brace
