// What is kept of a measurement, and when it is taken again. No device needed.
#include "runtime/gpu/measurements.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace::gpu {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class KeptMeasurements : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "brace_measured_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    device_.name = "a device";
    device_.driver = "driver 1";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// By an object of its own, as another process would; adds what it had to measure to taken_.
  Measurement ask(std::vector<double> times_ms = {2.0, 1.0},
                  Measurements::Use use = Measurements::Use::kept) {
    Measurements measurements(folder_, use);
    const Measurement found = measurements.get(device_, wanted_, [&] { return times_ms; });
    taken_ += measurements.taken();
    return found;
  }
  std::vector<std::filesystem::path> entries() const {
    return {std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()};
  }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(entries().front()).rdbuf();
    return all.str();
  }
  void overwrite(const std::string& content) const {
    std::ofstream(entries().front(), std::ios::trunc) << content;
  }

  std::filesystem::path folder_;
  DeviceInfo device_;
  Comparison wanted_{"walking or riding", "abc", {"walk", "ride"}};
  int taken_ = 0;
};

TEST_F(KeptMeasurements, ASecondProcessFindsWhatTheFirstOneMeasured) {
  EXPECT_FALSE(ask().from_cache);
  const Measurement again = ask({9.0, 9.0});
  EXPECT_EQ(taken_, 1);
  EXPECT_TRUE(again.from_cache);
  EXPECT_THAT(again.times_ms, ElementsAre(2.0, 1.0));
  EXPECT_THAT(again.origin(), testing::MatchesRegex("measured 20[0-9-]+, cached"));
  EXPECT_THAT(text(), testing::AllOf(HasSubstr("\"device\": \"a device\""), HasSubstr("\"ride\": 1.0")));
  EXPECT_EQ(entries().size(), 1U) << "no file that was written aside stays";
}

TEST_F(KeptMeasurements, AnotherDriverDeviceKernelOrQuestionIsMeasuredAnew) {
  ask();
  device_.driver = "driver 2";
  ask();
  device_.name = "another device";
  ask();
  wanted_.kernels = "abd";
  ask();
  wanted_.what = "walking or flying";
  ask();
  EXPECT_EQ(taken_, 5);
  EXPECT_EQ(entries().size(), 5U);
}

TEST_F(KeptMeasurements, DamagedFilesAreMeasuredAnewAndReplaced) {
  ask();
  const std::string whole = text();
  std::string negative = whole, renamed = whole, foreign = whole;
  negative.replace(negative.find("1.0"), 3, "-1.");
  renamed.replace(renamed.find("ride"), 4, "hide");
  foreign.replace(foreign.find("driver 1"), 8, "driver 3");
  const std::vector<std::string> damaged = {
      "",       "{",     "[]",   "null", "\xff\xfe", whole.substr(0, whole.size() / 2), R"({"times_ms": 3})",
      negative, renamed, foreign};
  for (const std::string& content : damaged) {
    overwrite(content);
    taken_ = 0;
    EXPECT_THAT(ask().times_ms, ElementsAre(2.0, 1.0));
    EXPECT_EQ(taken_, 1) << content;
    EXPECT_EQ(text(), whole);
  }
}

TEST_F(KeptMeasurements, WithoutAFolderToWriteToEveryProcessMeasuresOnceAndSaysSo) {
  const std::filesystem::path file = folder_ / "file";
  std::ofstream(file) << "in the way";
  for (const std::filesystem::path& folder : {file / "measured", std::filesystem::path()}) {
    Measurements measurements(folder);
    for (int i = 0; i < 3; ++i) {
      const Measurement found = measurements.get(device_, wanted_, [] { return std::vector{2.0, 1.0}; });
      EXPECT_THAT(found.origin(), HasSubstr("not kept"));
    }
    EXPECT_EQ(measurements.taken(), 1);
  }
}

TEST_F(KeptMeasurements, MeasuringAnewReplacesWhatIsKept) {
  ask();
  ask({5.0, 6.0}, Measurements::Use::anew);
  EXPECT_EQ(taken_, 2);
  EXPECT_THAT(ask().times_ms, ElementsAre(5.0, 6.0));
  EXPECT_EQ(taken_, 2);
}

TEST_F(KeptMeasurements, TimesThatCannotBeComparedAreRefusedAndNotKept) {
  const double not_a_number = std::nan("");
  for (const std::vector<double>& times : {std::vector{0.0, 1.0}, {1.0}, {1.0, not_a_number}, {1.0, -2.0}})
    EXPECT_THROW(ask(times), Error);
  EXPECT_THAT(entries(), IsEmpty());
}

TEST(MeasurementFolder, LiesBesideTheKernels) {
  EXPECT_EQ(default_measurement_folder().filename(), "measured");
  EXPECT_EQ(default_measurement_folder().parent_path().filename(), "brace");
}

}  // namespace
}  // namespace brace::gpu
