// `brace compare`: equal runs pass, a worse one ends with 1, what cannot be compared with 2.
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

class CliCompare : public testing::Test {
 protected:
  void SetUp() override {
    place_.write("s.toml", quick_session());
    run("a", "scene.size_m=0.4");
  }
  void run(const std::string& name, const std::string& setting) const {
    const Outcome outcome = place_.brace({"run", "s.toml", "--out", name, "--set", setting});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Workplace place_;
};

TEST_F(CliCompare, ARunIsNotWorseThanItselfAndEveryDifferenceIsZero) {
  const Outcome outcome = place_.brace({"compare", "a", "a", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["passed"].get<bool>());
  ASSERT_EQ(json["series"].size(), 1U);
  EXPECT_EQ(json["series"][0]["vsyncs_paired"], 10);
  EXPECT_GE(json["series"][0]["figures"].size(), 8U);
  for (const auto& figure : json["series"][0]["figures"]) {
    EXPECT_EQ(figure["difference"], 0.0) << figure;
    EXPECT_EQ(figure["verdict"], "same") << figure;
  }
}

TEST_F(CliCompare, MoreWorkIsWorseOneWayAndBetterTheOther) {
  run("b", "scene.size_m=0.6");
  const Outcome worse = place_.brace({"compare", "a", "b"});
  EXPECT_EQ(worse.exit_code, 1) << worse.out << worse.err;
  EXPECT_THAT(worse.out, HasSubstr("FAILED"));
  const Outcome better = place_.brace({"compare", "b", "a"});
  EXPECT_EQ(better.exit_code, 0) << better.out << better.err;
  EXPECT_THAT(better.out, HasSubstr("better"));
  const Outcome again = place_.brace({"compare", "a", "b"});
  EXPECT_EQ(again.out, worse.out) << "the bootstrap is seeded";
}

TEST_F(CliCompare, WhatCannotBeComparedIsRefused) {
  const auto refused = [&](const std::vector<std::string>& arguments, const char* message) {
    const Outcome outcome = place_.brace(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(outcome.out, "");
  };
  refused({"compare", "a", "nothing"}, "nothing: is no run directory");
  refused({"compare", "a", "a", "--tolerance", "dsim=1"}, "did you mean 'dssim'?");
  refused({"compare", "a", "a", "--tolerance", "samples=-1"}, "number >= 0");
  refused({"compare", "a", "a", "--tolerance", "missed_ratio.p99=1"}, "accepted: mean");
  refused({"compare", "a", "a", "--tolerance", "dssim=0.1"}, "cannot be checked");
}

}  // namespace
}  // namespace brace
