#include "bench/skip_scenes.hpp"

#include <algorithm>
#include <cmath>

namespace brace::bench {

std::uint32_t noise(int x, int y, int z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b1u ^
                    static_cast<std::uint32_t>(y) * 0x85ebca77u ^ static_cast<std::uint32_t>(z) * 0xc2b2ae3du;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  return (h ^ (h >> 12)) >> 24;
}

namespace {

int clamp_byte(double value) {
  return static_cast<int>(std::clamp(value, 1.0, 255.0));
}

/// Skin, skull and brain of an ellipsoid; q is 1 on its surface.
int head(double q, std::uint32_t n) {
  if (q > 1.0) return 0;
  if (q > 0.90) return clamp_byte(70.0 + 0.15 * n);
  if (q > 0.78) return clamp_byte(185.0 + 0.25 * n);
  return clamp_byte(95.0 + 40.0 * std::sin(9.0 * q) + 0.12 * n);
}

class SceneSource final : public VolumeSource {
 public:
  SceneSource(const SkipScene& scene, VolumeInfo info) : VolumeSource(std::move(info)), name_(scene.name) {}

 private:
  void produce(std::span<std::byte> out, int z_begin, int z_count) override {
    const auto [nx, ny, nz] = info().dims;
    std::size_t at = 0;
    for (int z = z_begin; z < z_begin + z_count; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
          out[at++] =
              static_cast<std::byte>(value(x, y, z, 2.0 * x / nx - 1, 2.0 * y / ny - 1, 2.0 * z / nz - 1));
  }

  int value(int i, int j, int k, double x, double y, double z) const {
    if (name_ == "head") return head((x * x / 0.55 + y * y / 0.75 + z * z / 0.95), noise(i, j, k));
    if (name_ == "insect") return insect(i, j, k, x, y, z);
    return snake(i, j, k, x, y, z);
  }

  /// A shell, six legs and noise of the lowest values around them.
  static int insect(int i, int j, int k, double x, double y, double z) {
    const double q = std::sqrt(x * x / 0.16 + y * y / 0.42 + z * z / 0.12);
    if (q < 1.0 && q > 0.86) return clamp_byte(90.0 + 0.4 * noise(i, j, k));
    if (q <= 0.86)
      return q > 0.6 && noise(i / 4, j / 4, k / 4) > 200 ? clamp_byte(20.0 + 0.2 * noise(i, j, k)) : 0;
    const double foot = std::abs(y - 0.5 * std::round(2.0 * y));
    const double bend = z + 0.5 * std::abs(x);
    if (std::abs(y) < 0.7 && foot * foot + bend * bend < 0.0012)
      return clamp_byte(60.0 + 0.3 * noise(i, j, k));
    return 0;
  }

  /// A tube wound up in a mostly empty scan.
  static int snake(int i, int j, int k, double x, double y, double z) {
    const double around = std::hypot(x, y) - 0.62;
    const double turn = std::atan2(y, x) / 6.283185307179586;
    const double along = z / 0.5 - turn;
    const double height = (along - std::round(along)) * 0.5;
    const double q = std::hypot(around, height) / 0.11;
    if (q > 1.0 || std::abs(z) > 0.75) return 0;
    return q > 0.8 ? clamp_byte(120.0 + 0.3 * noise(i, j, k))
                   : clamp_byte(40.0 + 50.0 * q + 0.2 * noise(i, j, k));
  }

  std::string name_;
};

}  // namespace

std::vector<SkipScene> skip_scenes(int divisor) {
  std::vector<SkipScene> scenes = {{"head", "manix", {512, 512, 460}},
                                   {"insect", "stag beetle", {832, 832, 494}},
                                   {"snake", "kingsnake", {1024, 1024, 795}}};
  for (SkipScene& scene : scenes)
    for (int& dim : scene.dims)
      dim = std::max(dim / divisor, 8);
  return scenes;
}

std::unique_ptr<VolumeSource> open_skip_scene(const SkipScene& scene) {
  VolumeInfo info;
  info.dims = scene.dims;
  info.source = "benchmark scene " + scene.name;
  return std::make_unique<SceneSource>(scene, std::move(info));
}

TransferTable skip_table(int number) {
  TransferTable table;
  table.range = {0, 255};
  for (int i = 0; i < 256; ++i) {
    bool visible = true;
    if (number == 1) visible = i > 0;
    if (number == 3) visible = i >= 128;
    if (number == 4) visible = (i / 64) % 2 == 1;
    if (number == 5) visible = i >= 44;
    if (number == 6) visible = i >= 6 && i < 160;
    const double t = i / 255.0;
    table.entries.push_back({0.3 + 0.7 * t, t, 1.0 - t, visible ? 0.02 + 0.2 * t : 0.0});
  }
  return table;
}

}  // namespace brace::bench
