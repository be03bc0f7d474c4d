// The braces of rays/full_rate on the host against the kernels that they stand for, on every instruction set.
#include "runtime/raycast/host_braces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/unit/raycast/raycast_fixture.hpp"

namespace brace {
namespace {

/// A mapped buffer's elements.
template <typename Element>
std::vector<Element> read(const gpu::Buffer& buffer) {
  const auto* const first = reinterpret_cast<const Element*>(buffer.mapped().data());
  return {first, first + buffer.mapped().size() / sizeof(Element)};
}

/// Eyes outside, inside, one that looks along an axis, and one that sees nothing.
std::vector<EyeView> eyes(int width_px, int height_px) {
  EyeView away = look_at_centre({0.0, 0.0, 2.0}, width_px, height_px);
  away.world_from_eye.position = {9.0, 9.0, 9.0};
  return {look_at_centre({0.9, 0.7, 1.6}, width_px, height_px),
          look_at_centre({0.1, 0.2, 0.3}, width_px, height_px),
          look_at_centre({0.0, 0.0, 2.0}, width_px, height_px), away};
}

Volume small_volume() {
  Volume volume;
  volume.info.dims = {12, 9, 20};
  volume.info.spacing = {1.0, 2.0, 0.5};
  volume.voxels.resize(12 * 9 * 20);
  return volume;
}

class HostBracesTest : public RaycastTest {
 protected:
  void SetUp() override {
    RaycastTest::SetUp();
    if (IsSkipped()) return;
    if (!device().limits().is_software) GTEST_SKIP() << "the device does not map its buffers";
    volume_ = on_device(small_volume());
    transfer_ = TransferOnDevice(device(), smooth_table(small_volume(), {0.0, 255.0}), 0.5);
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  struct Eye {
    RayBuffers rays;
    EyeTarget target;
  };
  Eye eye_of(const EyeView& view, const std::optional<RayGrid>& grid = {}) {
    Eye eye{RayBuffers(device(), grid ? grid->across : view.width_px, grid ? grid->down : view.height_px),
            EyeTarget(device(), view.width_px, view.height_px)};
    CastPipeline::set_eye(device(), eye.target, view, {}, volume_, transfer_, grid);
    return eye;
  }
  CastPipeline::Resources resources(const Eye& eye, const std::optional<RayGrid>& grid = {}) {
    CastPipeline::Resources in{volume_, transfer_, eye.rays, eye.target};
    in.grid = grid;
    return in;
  }
  template <typename Record>
  void on_the_device(const Record& record) {
    gpu::CommandList commands(device(), "braces");
    record(commands);
    commands.barrier();
    gpu::submit_and_wait(commands);
  }

  VolumeOnDevice volume_;
  TransferOnDevice transfer_;
};

/// Those of this processor; the last is the one the program is compiled for.
template <typename Visit>
void for_each_instruction_set(const Visit& visit) {
  for (const std::int64_t set : {std::int64_t{HWY_AVX3}, std::int64_t{HWY_AVX2}, std::int64_t{HWY_SSE4},
                                 std::int64_t{HWY_NEON}, std::int64_t{HWY_STATIC_TARGET}}) {
    hwy::SetSupportedTargetsForTest(0);
    if ((set & hwy::SupportedTargets()) == 0) continue;
    hwy::SetSupportedTargetsForTest(set);
    SCOPED_TRACE(hwy::TargetName(set));
    visit();
  }
}

void expect_alike(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b, double tolerance) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(double{a[i].w} - double{b[i].w}));
    if (a[i].w == 0.0f && b[i].w == 0.0f) continue;  // a ray that misses enters nowhere
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(double{a[i][c]} - double{b[i][c]}));
  }
  EXPECT_LE(worst, tolerance);
}

TEST_F(HostBracesTest, OpenTheRaysOfTheKernel) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{7, 5}, std::pair{33, 19}}) {
    for (const EyeView& view : eyes(width, height)) {
      for (const std::optional<RayGrid>& grid :
           {std::optional<RayGrid>(), std::optional(RayGrid{width + 5, height + 3, 2, 1})}) {
        const Eye eye = eye_of(view, grid);
        const CastPipeline::Resources in = resources(eye, grid);
        const CastArea all{0, 0, in.rays_across(), in.rays_down()};
        on_the_device([&](auto& commands) { pipeline(volume_, {}).record_opening(commands, in, all); });
        const auto entries = read<glm::vec4>(eye.rays.entries);
        const auto directions = read<glm::vec4>(eye.rays.directions);
        for_each_instruction_set([&] {
          ASSERT_TRUE(maps_braces(in));
          const std::vector<glm::vec4> nothing(entries.size(), glm::vec4(-9.0f));
          gpu::upload_values(device(), eye.rays.entries, std::span(nothing));
          gpu::upload_values(device(), eye.rays.directions, std::span(nothing));
          open_on_host(in, all);
          expect_alike(read<glm::vec4>(eye.rays.entries), entries, 1e-4);
          auto opened = read<glm::vec4>(eye.rays.directions);
          for (std::size_t i = 0; i < opened.size(); ++i) {
            EXPECT_LE(glm::length(opened[i] - directions[i]), 1e-6f) << i;
          }
        });
      }
    }
  }
}

TEST_F(HostBracesTest, CloseThePictureOfTheKernel) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-0.1f, 1.1f);
  const EyeView view = look_at_centre({0.9, 0.7, 1.6}, 33, 19);
  const Eye eye = eye_of(view);
  const CastPipeline::Resources in = resources(eye);
  std::vector<glm::vec4> colours(33 * 19);
  std::vector<float> depths_m(33 * 19);
  for (glm::vec4& colour : colours)
    colour = {unit(random), unit(random), unit(random), unit(random)};
  for (float& depth_m : depths_m)
    depth_m = random() % 3 == 0 ? std::numeric_limits<float>::infinity() : unit(random);
  gpu::upload_values(device(), eye.rays.colours, std::span<const glm::vec4>(colours));
  gpu::upload_values(device(), eye.rays.depths_m, std::span<const float>(depths_m));
  on_the_device([&](auto& commands) { pipeline(volume_, {}).record_closing(commands, in, {0, 0, 33, 19}); });
  const auto image = read<std::uint32_t>(eye.target.image);
  for_each_instruction_set([&] {
    const std::vector<std::uint32_t> nothing(image.size(), 0x12345678u);
    gpu::upload_values(device(), eye.target.image, std::span(nothing));
    close_on_host(in, {0, 0, 33, 19});
    const auto closed = read<std::uint32_t>(eye.target.image);
    for (std::size_t i = 0; i < image.size(); ++i) {
      for (int c = 0; c < 32; c += 8)
        EXPECT_NEAR(static_cast<int>(closed[i] >> c & 255), static_cast<int>(image[i] >> c & 255), 1) << i;
    }
    EXPECT_EQ(read<float>(eye.target.depth), depths_m);
  });
}

TEST_F(HostBracesTest, TouchTheirAreaOnly) {
  const EyeView view = look_at_centre({0.9, 0.7, 1.6}, 20, 12);
  const Eye eye = eye_of(view);
  const CastPipeline::Resources in = resources(eye);
  const std::vector<glm::vec4> nothing(20 * 12, glm::vec4(-9.0f));
  const std::vector<std::uint32_t> no_picture(20 * 12, 0x12345678u);
  gpu::upload_values(device(), eye.rays.entries, std::span(nothing));
  gpu::upload_values(device(), eye.target.image, std::span(no_picture));
  open_on_host(in, {3, 2, 9, 7});
  close_on_host(in, {3, 2, 9, 7});
  const auto entries = read<glm::vec4>(eye.rays.entries);
  const auto image = read<std::uint32_t>(eye.target.image);
  for (std::size_t y = 0; y < 12; ++y) {
    for (std::size_t x = 0; x < 20; ++x) {
      const bool inside = x >= 3 && x < 12 && y >= 2 && y < 9;
      EXPECT_EQ(entries[y * 20 + x] != nothing[0], inside) << x << ' ' << y;
      EXPECT_EQ(image[y * 20 + x] != no_picture[0], inside) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace brace
