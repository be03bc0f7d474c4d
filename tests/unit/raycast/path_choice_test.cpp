// Which data path a volume takes where both would do: the one that was measured as the faster.
#include "runtime/raycast/path_choice.hpp"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "tests/unit/raycast/raycast_fixture.hpp"

namespace brace {
namespace {

const std::filesystem::path data_folder = BRACE_DATA_FOLDER;

VolumeInfo cube(int edge, VoxelType type = VoxelType::uint8) {
  VolumeInfo info;
  info.dims = {edge, edge, edge};
  info.type = type;
  info.source = "scan.nrrd";
  return info;
}

class PathChoice : public RaycastTest {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "brace_paths_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    RaycastTest::SetUp();
  }
  void TearDown() override {
    RaycastTest::TearDown();
    std::filesystem::remove_all(folder_);
  }

  /// By measurements of its own, as another process would; adds what it had to measure to taken_.
  VolumePathChoice choose(const VolumeInfo& volume, VolumePath wanted = VolumePath::automatic) {
    gpu::Measurements measurements(folder_);
    const VolumePathChoice choice = choose_volume_path(device(), volume, wanted, data_folder, measurements);
    taken_ += measurements.taken();
    return choice;
  }

  /// Puts other times into the one file that there is.
  void pretend(double sampler_ms, double packed_ms) const {
    const std::filesystem::path path = std::filesystem::directory_iterator(folder_)->path();
    auto json = nlohmann::ordered_json::parse(std::ifstream(path));
    json["times_ms"] = {{"sampler", sampler_ms}, {"packed", packed_ms}};
    std::ofstream(path, std::ios::trunc) << json;
  }

  std::filesystem::path folder_;
  int taken_ = 0;
};

TEST_F(PathChoice, IsMeasuredOncePerWidthOfVoxelsAndSaidInTheSameWords) {
  for (const VoxelType type : {VoxelType::uint8, VoxelType::uint16, VoxelType::float32}) {
    taken_ = 0;
    const VolumePathChoice first = choose(cube(32, type)), second = choose(cube(100, type));
    EXPECT_EQ(taken_, 1);
    EXPECT_EQ(first.path, second.path);
    EXPECT_EQ(first.reason, second.reason) << "equal runs are equal byte by byte";
    EXPECT_THAT(first.reason, testing::HasSubstr("by measurement on " + device().info().name));
    EXPECT_THAT(second.figures, testing::HasSubstr("cached"));
  }
  taken_ = 0;
  choose(cube(32, VoxelType::int16));
  EXPECT_EQ(taken_, 0) << "uint16 and int16 are the same to the device";
}

TEST_F(PathChoice, TheFasterPathIsTakenAndCloseTimesLeaveTheUsualOne) {
  choose(cube(32));
  pretend(1.0, 2.0);
  EXPECT_EQ(choose(cube(32)).path, VolumePath::sampler);
  EXPECT_THAT(choose(cube(32)).figures, testing::HasSubstr("sampler is 2.00 x as fast as packed"));
  pretend(2.0, 1.0);
  EXPECT_EQ(choose(cube(32)).path, VolumePath::packed);
  EXPECT_THAT(choose(cube(32)).reason, testing::StartsWith("packed: "));
  const VolumePath usual = usual_volume_path(device().limits()).path;
  for (const double sampler_ms : {0.95, 1.05}) {
    pretend(sampler_ms, 1.0);
    EXPECT_EQ(choose(cube(32)).path, usual);
  }
  EXPECT_EQ(taken_, 1);
}

TEST_F(PathChoice, WhatIsAskedForOrForcedByLimitsIsNotMeasured) {
  for (const VolumePath path : {VolumePath::sampler, VolumePath::packed})
    EXPECT_EQ(choose(cube(32), path).path, path);
  const VolumePathChoice large = choose(cube(500));  // packing takes four times 125 MB
  EXPECT_EQ(large.path, VolumePath::sampler);
  EXPECT_THAT(large.reason, testing::HasSubstr("packing would take"));
  EXPECT_THROW(choose(cube(100000)), Error);
  EXPECT_EQ(taken_, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(PathChoice, WithoutKernelsToMeasureWithTheUsualPathIsTaken) {
  gpu::Measurements measurements(folder_);
  const VolumePathChoice choice =
      choose_volume_path(device(), cube(32), VolumePath::automatic, folder_, measurements);
  EXPECT_EQ(choice.path, usual_volume_path(device().limits()).path);
  EXPECT_THAT(choice.reason, testing::HasSubstr("not measured: "));
  EXPECT_EQ(measurements.taken(), 0);
}

}  // namespace
}  // namespace brace
