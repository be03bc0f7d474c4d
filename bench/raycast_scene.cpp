#include "bench/raycast_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace brace {

namespace {

/// v = 255 clamp(ball + coarse texture + fine texture), each texture a sum of products of sines, which need
/// one table per axis and frequency only.
class BallVolume final : public VolumeSource {
 public:
  explicit BallVolume(const SceneBall& ball) : VolumeSource(make_info(ball)), ball_(ball) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < ball.dims[axis]; ++i)
        axes_[axis].push_back(place((2.0 * i + 1.0) / ball.dims[axis] - 1.0));
    }
  }

 private:
  struct Place {
    double x, sin_coarse, cos_coarse, sin_fine, cos_fine;
  };

  static Place place(double x) {
    return {x, std::sin(9.0 * x), std::cos(9.0 * x), std::sin(31.0 * x + 1.0), std::cos(31.0 * x + 1.0)};
  }

  static VolumeInfo make_info(const SceneBall& ball) {
    VolumeInfo info;
    info.dims = ball.dims;
    info.source = "benchmark scene";
    return info;
  }

  std::byte voxel(const Place& a, const Place& b, const Place& c) const {
    const double radius = std::sqrt(a.x * a.x + b.x * b.x + c.x * c.x);
    const double coarse =
        a.sin_coarse * b.cos_coarse + b.sin_coarse * c.cos_coarse + c.sin_coarse * a.cos_coarse;
    const double fine = a.sin_fine * b.cos_fine + b.sin_fine * c.cos_fine + c.sin_fine * a.cos_fine;
    const double value = ball_.slope * (ball_.radius - radius) + 0.3 * coarse + 0.1 * fine;
    return static_cast<std::byte>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  }

  void produce(std::span<std::byte> out, int z_begin, int z_count) override {
    std::size_t at = 0;
    for (int z = z_begin; z < z_begin + z_count; ++z) {
      for (const Place& y : axes_[1]) {
        for (const Place& x : axes_[0])
          out[at++] = voxel(x, y, axes_[2][static_cast<std::size_t>(z)]);
      }
    }
  }

  SceneBall ball_;
  std::array<std::vector<Place>, 3> axes_;
};

TransferFunction ramp(const char* name, double visible_above, const TransferSample& low,
                      const TransferSample& high) {
  TransferFunction function;
  function.name = name;
  function.source = "benchmark scene";
  TransferSample empty = low;
  empty.kappa = 0.0;
  if (visible_above > 0.0) function.points.push_back({0.0, empty});
  if (visible_above >= 0.0) function.points.push_back({visible_above, empty});
  function.points.push_back({visible_above + 1.0, low});
  function.points.push_back({255.0, high});
  return function;
}

}  // namespace

std::unique_ptr<VolumeSource> open_scene_volume(const SceneBall& ball) {
  return std::make_unique<BallVolume>(ball);
}

TransferFunction scene_transfer(const std::string& name, double visible_above, double absorption_scale) {
  const double k = absorption_scale;
  if (name == "T") return ramp("T", visible_above, {0.2, 0.3, 0.8, 0.002 * k}, {1.0, 0.6, 0.3, 0.02 * k});
  return ramp("S", visible_above, {0.9, 0.8, 0.6, 0.4 * k}, {1.0, 0.9, 0.8, 2.0 * k});
}

RaycastScene make_raycast_scene(int width_px, int height_px) {
  RaycastScene scene;
  scene.transfers = {{"T", scene_transfer("T", 20.0)}, {"S", scene_transfer("S", 140.0)}};
  scene.placement.size_m = 1.0;
  scene.placement.world_from_volume.orientation = quat_exp({0.35, 0.6, 0.0});
  scene.eye.world_from_eye.position = {0.0, 0.0, 2.2};
  const double half = std::tan(15.0 * std::numbers::pi / 180.0);
  scene.eye.tan_left = scene.eye.tan_bottom = -half;
  scene.eye.tan_right = scene.eye.tan_top = half;
  scene.eye.width_px = width_px;
  scene.eye.height_px = height_px;
  return scene;
}

}  // namespace brace
