// Where voxels and eyes lie, and which data path a volume takes. No device needed.
#include <cmath>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "runtime/raycast/packed_layout.hpp"
#include "runtime/raycast/volume_on_device.hpp"
#include "tests/unit/raycast/raycast_fixture.hpp"

namespace brace {
namespace {

gpu::DeviceLimits lavapipe_limits() {
  gpu::DeviceLimits limits;
  limits.storage_buffer_bytes_max = std::uint64_t{1} << 27;
  limits.allocation_bytes_max = std::uint64_t{1} << 31;
  limits.texel_buffer_texels_max = std::uint64_t{1} << 27;
  limits.image_3d_px_max = 4096;
  limits.is_software = true;
  return limits;
}

VolumeInfo volume_of(int x, int y, int z, VoxelType type = VoxelType::uint8) {
  VolumeInfo info;
  info.dims = {x, y, z};
  info.type = type;
  info.source = "scan.nrrd";
  return info;
}

TEST(VolumePath, SoftwareDevicePacksWhatFits) {
  const auto choice = choose_volume_path(volume_of(256, 256, 256), lavapipe_limits());
  EXPECT_EQ(choice.path, VolumePath::packed);
  EXPECT_THAT(choice.reason, testing::HasSubstr("software"));
}

TEST(VolumePath, GpuSamples) {
  auto limits = lavapipe_limits();
  limits.is_software = false;
  EXPECT_EQ(choose_volume_path(volume_of(256, 256, 256), limits).path, VolumePath::sampler);
}

TEST(VolumePath, LargeVolumeFallsBackToTheSamplerAndSaysWhy) {
  const auto scan = choose_volume_path(volume_of(1024, 1024, 795), lavapipe_limits());
  EXPECT_EQ(scan.path, VolumePath::sampler);
  EXPECT_THAT(scan.reason, testing::HasSubstr("packed texels are over the device's 134217728"));
  const auto memory = choose_volume_path(volume_of(512, 512, 460), lavapipe_limits());
  EXPECT_EQ(memory.path, VolumePath::sampler);
  EXPECT_THAT(memory.reason, testing::HasSubstr("memory"));
}

TEST(VolumePath, WhatTheDeviceCannotGiveIsRefusedWithTheLimit) {
  try {
    choose_volume_path(volume_of(1024, 1024, 795), lavapipe_limits(), VolumePath::packed);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::device_or_plugin_failed);
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("scan.nrrd"), testing::HasSubstr("134217728")));
  }
  EXPECT_THROW(choose_volume_path(volume_of(5000, 1000, 1000), lavapipe_limits()), Error);
  EXPECT_THROW(parse_volume_path("texture"), Error);
  EXPECT_EQ(parse_volume_path("auto"), VolumePath::automatic);
}

/// The voxel of a packed texel by the layout's definition: corner (dx, dy) of texel (x, y).
std::uint32_t expected(const std::vector<std::uint32_t>& voxels, const VolumeInfo& info, int x, int y) {
  const int cx = std::clamp(x, 0, info.dims[0] - 1);
  const int cy = std::clamp(y, 0, info.dims[1] - 1);
  return voxels[static_cast<std::size_t>(cy * info.dims[0] + cx)];
}

template <typename Voxel>
void check_packing(VoxelType type, int width, int height) {
  const VolumeInfo info = volume_of(width, height, 1, type);
  std::vector<Voxel> slice;
  std::vector<std::uint32_t> wide;
  for (int i = 0; i < width * height; ++i) {
    slice.push_back(static_cast<Voxel>(i * 37 + 11));
    wide.push_back(slice.back());
  }
  const PackedLayout layout(info);
  std::vector<std::uint32_t> texels(layout.slice_texels);
  pack_slice(layout, std::as_bytes(std::span(slice)), texels);
  const int bits = static_cast<int>(sizeof(Voxel)) * 8;
  for (int y = 0; y < static_cast<int>(layout.rows); ++y) {
    for (int x = 0; x < static_cast<int>(layout.row_texels); ++x) {
      std::uint32_t texel = expected(wide, info, x - 1, y - 1);
      if (bits < 32) texel |= expected(wide, info, x, y - 1) << bits;
      if (bits < 16) texel |= expected(wide, info, x - 1, y) << 16 | expected(wide, info, x, y) << 24;
      ASSERT_EQ(texels[static_cast<std::size_t>(y) * layout.row_texels + static_cast<std::size_t>(x)], texel)
          << x << "," << y << " of " << width << "x" << height;
    }
  }
}

TEST(PackedLayout, HoldsTheNeighboursOfEveryCellWithAnApron) {
  for (const auto& [width, height] : {std::pair(1, 1), {1, 4}, {5, 1}, {4, 3}}) {
    check_packing<std::uint8_t>(VoxelType::uint8, width, height);
    check_packing<std::uint16_t>(VoxelType::uint16, width, height);
    check_packing<std::uint32_t>(VoxelType::float32, width, height);
  }
}

TEST(EyeView, VoxelCoordinatesFollowTheCentredBox) {
  VolumeInfo info = volume_of(10, 20, 40);
  info.spacing = {2.0, 1.0, 0.25};
  VolumePlacement placement;
  placement.size_m = 2.0;  // the box is 20 x 20 x 10, hence 2 x 2 x 1 m
  placement.world_from_volume.position = {1.0, 2.0, 3.0};
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-12; };
  EXPECT_TRUE(near(voxel_from_world(info, placement, {1, 2, 3}), {5, 10, 20}));
  EXPECT_TRUE(near(voxel_from_world(info, placement, {0, 1, 2.5}), {0, 0, 0}));
  EXPECT_TRUE(near(voxel_from_world(info, placement, {2, 3, 3.5}), {10, 20, 40}));
  EXPECT_DOUBLE_EQ(metres_per_unit(info, placement), 0.25 * 2.0 / 20.0);
  placement.world_from_volume.orientation =
      quat_exp({0, 0, std::acos(0.0)});  // x of the volume is y of the world
  EXPECT_TRUE(near(voxel_from_world(info, placement, {1, 3, 3}), {10, 10, 20}));
}

TEST(EyeView, RefusesWhatCannotBeSeenThrough) {
  const VolumeInfo info = volume_of(8, 8, 8);
  EyeView eye = look_at_centre({0, 0, 2});
  EXPECT_NO_THROW(eye_params(eye, info, {}));
  EyeView empty = eye;
  empty.width_px = 0;
  EXPECT_THROW(eye_params(empty, info, {}), Error);
  EyeView inverted = eye;
  inverted.tan_left = 1.0;
  EXPECT_THROW(eye_params(inverted, info, {}), Error);
  EyeView lost = eye;
  lost.world_from_eye.position.x = NAN;
  EXPECT_THROW(eye_params(lost, info, {}), Error);
  VolumePlacement flat;
  flat.size_m = 0.0;
  EXPECT_THROW(eye_params(eye, info, flat), Error);
}

}  // namespace
}  // namespace brace
