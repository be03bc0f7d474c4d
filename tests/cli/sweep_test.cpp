// `brace sweep`: the same results however it is run, failures recorded, on from where it was.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::quick_session;
using test::Workplace;
using testing::HasSubstr;

class CliSweep : public testing::Test {
 protected:
  void SetUp() override { place_.write("base.toml", quick_session()); }
  Outcome sweep(const std::string& text, std::vector<std::string> more = {}) const {
    place_.write("sweep.toml", text);
    std::vector<std::string> arguments = {"sweep", "sweep.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return place_.brace(arguments);
  }
  Workplace place_;
};

const std::string sizes =
    "session = \"base.toml\"\n[grid]\nscene.size_m = [0.3, 0.6]\npipeline.warp = [\"none\", \"quad\"]\n";

TEST_F(CliSweep, OneJobAndSeveralGiveTheSameBytes) {
  const Outcome one = sweep(sizes, {"--jobs", "1", "--out", "one", "--json"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(nlohmann::json::parse(one.out)["done"], 4);
  ASSERT_EQ(sweep(sizes, {"--jobs", "3", "--out", "three"}).exit_code, 0);
  EXPECT_EQ(place_.read("one/results.csv"), place_.read("three/results.csv"));
  EXPECT_THAT(place_.read("one/results.csv"), HasSubstr("\n4,1,1,done,0,0,,0.6,quad,10,"));
}

TEST_F(CliSweep, AFailedPointIsRecordedAndTriedAgainOnRequestOnly) {
  const std::string text =
      "session = \"base.toml\"\n[[point]]\nscene.volume = \"generator:solid_box:8\"\n[[point]]\nscene.volume "
      "= \"later.nrrd\"\n";
  const Outcome first = sweep(text);
  EXPECT_EQ(first.exit_code, 1) << first.err;
  EXPECT_THAT(first.err, HasSubstr("later.nrrd"));
  EXPECT_THAT(place_.read("sweeps/sweep/results.csv"), HasSubstr("\n2,1,1,failed,2,"));
  place_.write("later.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n@ABCDEFG");
  EXPECT_EQ(sweep(text).exit_code, 1) << "not run again by itself";
  EXPECT_EQ(sweep(text, {"--retry-failed"}).exit_code, 0);
}

TEST_F(CliSweep, TwoSweepsAreComparedPointByPoint) {
  ASSERT_EQ(sweep(sizes, {"--out", "a"}).exit_code, 0);
  ASSERT_EQ(sweep(sizes + "[set]\nclock.cost_scale = 40.0\n", {"--out", "b"}).exit_code, 0);
  const Outcome same = place_.brace({"compare", "a", "a", "--json"});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  const auto json = nlohmann::json::parse(same.out);
  EXPECT_EQ(json["unit"], "points");
  EXPECT_EQ(json["series"][0]["vsyncs_paired"], 4);
  EXPECT_GE(json["series"][0]["figures"].size(), 5U);
  const Outcome worse = place_.brace({"compare", "a", "b"});
  EXPECT_EQ(worse.exit_code, 1) << worse.out;
  EXPECT_THAT(worse.out, HasSubstr("4 points in both"));
  EXPECT_EQ(place_.brace({"compare", "b", "a"}).exit_code, 0) << "better is not worse";
  ASSERT_EQ(sweep("session = \"base.toml\"\n[grid]\nrun.seed = [1]\n", {"--out", "c"}).exit_code, 0);
  EXPECT_THAT(place_.brace({"compare", "a", "c"}).err, HasSubstr("vary other keys"));
  const Outcome none = place_.brace({"compare", "a", "nowhere"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("nowhere"));
}

int number_from(const char* variable, int fallback) {
  const char* text = std::getenv(variable);
  return text == nullptr ? fallback : std::atoi(text);
}

/// BRACE_SWEEP_POINTS and BRACE_SWEEP_KILLS make it long: 200 and 10 are the claim.
TEST_F(CliSweep, KilledAgainAndAgainItEndsLikeAnUndisturbedOne) {
  const int points = number_from("BRACE_SWEEP_POINTS", 8), kills = number_from("BRACE_SWEEP_KILLS", 3);
  std::string text = "session = \"base.toml\"\n[grid]\nrun.seed = [1";
  for (int seed = 2; seed <= points; ++seed)
    text += fmt::format(", {}", seed);
  text += "]\n";
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(sweep(text, {"--out", "whole"}).exit_code, 0);
  const double whole_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::mt19937 random(7);
  int killed = 0;
  for (int i = 0; i < kills; ++i) {
    const double after_s = whole_s * (0.2 + static_cast<double>(random() >> 8) * 0x1p-24) / (kills + 1);
    const Outcome outcome = place_.command({"/usr/bin/timeout", "-s", "KILL", fmt::format("{:.3f}", after_s),
                                            BRACE_PROGRAM, "sweep", "sweep.toml", "--out", "killed"});
    killed += outcome.exit_code != 0;
  }
  EXPECT_GT(killed, 0);
  ASSERT_EQ(sweep(text, {"--out", "killed"}).exit_code, 0);
  EXPECT_EQ(place_.read("killed/results.csv"), place_.read("whole/results.csv"));
}

TEST_F(CliSweep, BadSweepsNameFileAndPointBeforeAnythingRuns) {
  const auto refused = [&](const std::string& text, const std::string& message) {
    const Outcome outcome = sweep(text, {"--out", "out"});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(place_ / "out"));
  };
  refused("session = \"base.toml\"\n[grid]\npipeline.warp = [\"quad\", \"quda\"]\n", "point 2");
  refused("session = \"none.toml\"\n[grid]\nrun.seed = [1]\n", "none.toml");
  refused("session = \"base.toml\"\n[grid]\nrun.sede = [1]\n", "sede");
  place_.write("mine/letter.txt", "keep me");
  const Outcome foreign = sweep(sizes, {"--out", "mine"});
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.err, HasSubstr("letter.txt"));
  EXPECT_EQ(place_.read("mine/letter.txt"), "keep me");
}

}  // namespace
}  // namespace brace
