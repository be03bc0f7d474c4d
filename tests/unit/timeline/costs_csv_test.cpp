#include "runtime/timeline/costs_csv.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

class CostsCsv : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  std::filesystem::path write(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return path_;
  }

  std::string error_of(const std::string& text) {
    try {
      read_costs_csv(write(text));
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
      return error.what();
    }
    ADD_FAILURE() << "no error for " << text;
    return {};
  }

  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("costs_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv");
};

std::vector<JobRecord> records() {
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return {{.job = 0,
           .kind = JobKind::cast,
           .index = 3,
           .submit_ns = 1,
           .start_ns = 2,
           .end_ns = 30,
           .preempted_ns = 5,
           .cost_ns = 23,
           .work = {1, 2, 3, 4, 5, 6}},
          {.job = 1, .kind = JobKind::warp, .index = 9, .submit_ns = 7, .cost_ns = 9'000'000'000'000'000'000},
          {.job = 2, .kind = JobKind::update, .work = {most, 0, 0, 0, 0, most}}};
}

TEST_F(CostsCsv, RoundTripsEveryField) {
  EXPECT_EQ(read_costs_csv(write(to_costs_csv(records()))), records());
}

TEST_F(CostsCsv, LeavesWhatIsNotThereEmpty) {
  const std::string text = to_costs_csv(std::vector<JobRecord>{records()[1]});
  EXPECT_EQ(text,
            "job,kind,index,submit_ns,start_ns,end_ns,preempted_ns,cost_ns,rays,samples,skip_steps,"
            "shading_fetches,texels,bytes\n1,warp,9,7,,,0,9000000000000000000,0,0,0,0,0,0\n");
}

TEST_F(CostsCsv, FindsColumnsByNameAndIgnoresOthers) {
  const auto read = read_costs_csv(
      write("bytes,extra,texels,shading_fetches,skip_steps,samples,rays,cost_ns,preempted_ns,end_ns,start_ns,"
            "submit_ns,index,kind,job\r\n6,x,5,4,3,2,1,23,5,30,2,1,3,cast,0\r\n"));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0], records()[0]);
}

TEST_F(CostsCsv, ErrorsNameFileLineAndColumn) {
  const std::string header = costs_csv_header();
  EXPECT_THAT(error_of(""), HasSubstr("empty"));
  EXPECT_THAT(error_of("job,kind\n"), HasSubstr("index"));
  EXPECT_THAT(error_of(header + "0,cast,1\n"), HasSubstr(":2: 3 cells"));
  EXPECT_THAT(error_of(header + "0,draw,1,0,0,0,0,1,0,0,0,0,0,0\n"), HasSubstr("cast, warp, update"));
  EXPECT_THAT(error_of(header + "0,cast,1,0,0,0,0,1.5,0,0,0,0,0,0\n"), HasSubstr("cost_ns: '1.5'"));
  EXPECT_THAT(error_of(header + "0,cast,1,0,0,0,0,,0,0,0,0,0,0\n"), HasSubstr("cost_ns"));
  EXPECT_THAT(error_of(header + "0,cast,1,0,0,0,0,-7,0,0,0,0,0,0\n"), HasSubstr(">= 0"));
  EXPECT_THAT(error_of(header + "0,cast,1,0,0,0,0,1,-1,0,0,0,0,0\n"), HasSubstr("rays"));
  EXPECT_THAT(error_of(header + "0,cast,1,0,0,0,0,99999999999999999999,0,0,0,0,0,0\n"), HasSubstr("cost_ns"));
  std::filesystem::remove(path_);
  EXPECT_THROW(read_costs_csv(path_), Error);
}

}  // namespace
}  // namespace brace
