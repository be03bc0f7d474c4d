#include "runtime/sweep/results.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/sweep/database.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

class Results : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("brace-sweep-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    sweep_ = parse_sweep("session = \"s.toml\"\nrepeat = 2\n[grid]\nrun.frames = [1, 2]\n", "sweep.toml");
    for (const SweepPoint& point : sweep_.points)
      points_.push_back({point, "resolved " + point.place, 7, false});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  SweepResults open() const { return {folder_ / "results.sqlite", sweep_, points_, "1.0"}; }
  std::string csv(SweepResults& results) const {
    results.write_csv(folder_ / "results.csv");
    std::ifstream in(folder_ / "results.csv");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static SweepOutcome done(double figure) {
    SweepOutcome outcome;
    outcome.status = SweepOutcome::Status::done;
    outcome.figures.assign(sweep_figure_names().size(), figure);
    return outcome;
  }
  static SweepOutcome failed(const std::string& why) {
    SweepOutcome outcome;
    outcome.status = SweepOutcome::Status::failed;
    outcome.exit_code = 2;
    outcome.message = why;
    return outcome;
  }

  std::filesystem::path folder_;
  SweepFile sweep_;
  std::vector<PlannedPoint> points_;
};

TEST_F(Results, WaitForWhoeverLooksAtThem) {
  Database ours(folder_ / "shared.sqlite"), theirs(folder_ / "shared.sqlite");
  ours.execute("create table t (a)");
  theirs.execute("begin exclusive");
  std::thread lets_go([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    theirs.execute("commit");
  });
  EXPECT_NO_THROW(ours.execute("insert into t values (1)"));
  lets_go.join();
}

TEST_F(Results, GoOnWhereTheyWere) {
  {
    SweepResults results = open();
    ASSERT_EQ(results.pending().size(), 4u);
    EXPECT_EQ(results.pending()[1], (SweepRun{1, 2, 8})) << "repetition k has seed + k - 1";
    results.record(results.pending()[0], done(0.25));
  }
  SweepResults again = open();
  EXPECT_EQ(again.pending().size(), 3u);
  EXPECT_EQ(again.counts().done, 1);
  const std::string text = csv(again);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
  EXPECT_THAT(text, HasSubstr("\n1,1,7,done,"));
  EXPECT_THAT(text, HasSubstr("\n2,2,8,pending,"));
  EXPECT_THAT(text, HasSubstr(",0.25"));
}

TEST_F(Results, OrderOfRecordingChangesNothing) {
  SweepResults forwards = open();
  const auto runs = forwards.pending();
  for (const SweepRun& run : runs)
    forwards.record(run, done(static_cast<double>(run.point)));
  const std::string expected = csv(forwards);
  std::filesystem::remove(folder_ / "results.sqlite");
  SweepResults backwards = open();
  for (auto run = runs.rbegin(); run != runs.rend(); ++run)
    backwards.record(*run, done(static_cast<double>(run->point)));
  EXPECT_EQ(csv(backwards), expected);
}

TEST_F(Results, FailuresStayUntilAskedForAgainAndTextIsQuoted) {
  SweepResults results = open();
  results.record(results.pending()[0], failed("no \"volume\", here"));
  EXPECT_EQ(results.pending().size(), 3u);
  EXPECT_EQ(results.counts().failed, 1);
  EXPECT_THAT(csv(results), HasSubstr("\"no \"\"volume\"\", here\""));
  results.retry_failed();
  EXPECT_EQ(results.pending().size(), 4u);
  EXPECT_EQ(results.counts().failed, 0);
}

TEST_F(Results, AnotherSweepIsRefused) {
  (void)open();
  points_.pop_back();
  sweep_.points.pop_back();
  try {
    (void)open();
    FAIL() << "was taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(e.what(), HasSubstr("results.sqlite"));
  }
  std::ofstream(folder_ / "results.sqlite") << "no database at all, but long enough to be read as one";
  EXPECT_THROW((void)open(), Error);
}

}  // namespace
}  // namespace brace
