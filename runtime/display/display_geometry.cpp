#include "runtime/display/display_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/gtc/quaternion.hpp>

#include "base/error.hpp"

namespace brace {
namespace {

void check(const sim::FovTangents& fov, const char* whose) {
  const bool finite = std::isfinite(fov.left) && std::isfinite(fov.right) && std::isfinite(fov.bottom) &&
                      std::isfinite(fov.top);
  if (!finite || fov.left >= fov.right || fov.bottom >= fov.top)
    throw input_error(
        "the field of view of the {} has no area: tangents left {}, right {}, bottom {}, top {}", whose,
        fov.left, fov.right, fov.bottom, fov.top);
}

void check(int width_px, int height_px, const char* what) {
  constexpr int edge_max = 1 << 16;
  if (width_px < 2 || height_px < 2 || width_px > edge_max || height_px > edge_max)
    throw input_error("the {} has {} x {} pixels; accepted: 2 to {} along each edge", what, width_px,
                      height_px, edge_max);
}

// The largest float below `limit`: a coordinate that still has a texel to its right.
float just_below(int limit) {
  return std::nextafter(static_cast<float>(limit), 0.0f);
}

void set(float (&to)[4], double x, double y, double z, double w) {
  to[0] = static_cast<float>(x);
  to[1] = static_cast<float>(y);
  to[2] = static_cast<float>(z);
  to[3] = static_cast<float>(w);
}

void set_pose(float (&to)[4][4], const Pose& old_from_new) {
  const glm::dvec3& t = old_from_new.position;
  if (!std::isfinite(glm::dot(old_from_new.orientation, old_from_new.orientation) + glm::dot(t, t)))
    throw input_error("the pose of an eye is not finite");
  const glm::dmat3 rotation = glm::mat3_cast(old_from_new.orientation);
  for (int column = 0; column < 3; ++column)
    set(to[column], rotation[column].x, rotation[column].y, rotation[column].z, 0.0);
  set(to[3], t.x, t.y, t.z, 0.0);
}

bool pixel_visible(const PanelEye& eye, const std::array<double, 3>& usable, int x, int y) {
  const glm::dvec2 uv((x + 0.5) / eye.width_px, (y + 0.5) / eye.height_px);
  for (const sim::Channel channel : sim::all_channels) {
    const auto tangents =
        sim::panel_to_tangents(eye.lens, channel, usable[static_cast<std::size_t>(channel)], uv);
    if (tangents && tangents->x >= eye.fov.left && tangents->x <= eye.fov.right &&
        tangents->y >= eye.fov.bottom && tangents->y <= eye.fov.top)
      return true;
  }
  return false;
}

bool tile_visible(const PanelEye& eye, const std::array<double, 3>& usable, int left, int top) {
  for (int y = top; y < std::min(top + tile_height_px, eye.height_px); ++y)
    for (int x = left; x < std::min(left + tile_width_px, eye.width_px); ++x)
      if (pixel_visible(eye, usable, x, y)) return true;
  return false;
}

std::array<double, 3> usable_radii(const sim::EyeLens& lens) {
  std::array<double, 3> usable;
  for (const sim::Channel channel : sim::all_channels)
    usable[static_cast<std::size_t>(channel)] = sim::usable_radius(lens, channel);
  return usable;
}

}  // namespace

LensTraits lens_traits(const sim::EyeLens& lens) {
  LensTraits traits;
  traits.kind = lens.kind == sim::LensKind::none_published ? sim::LensKind::identity : lens.kind;
  traits.one_centre =
      lens.rgb[0].centre_uv == lens.rgb[1].centre_uv && lens.rgb[1].centre_uv == lens.rgb[2].centre_uv;
  traits.one_fetch = sim::lens_channels_equal(lens) && traits.one_centre;
  return traits;
}

LensTraits common_traits(const LensTraits& left, const LensTraits& right) {
  if (left.kind != right.kind)
    throw input_error("the eyes have different lens models: {} and {}", sim::to_string(left.kind),
                      sim::to_string(right.kind));
  return {left.kind, left.one_centre && right.one_centre, left.one_fetch && right.one_fetch};
}

BraceDisplayParams display_params(const PanelEye& eye, const SourcePicture& source) {
  check(eye.width_px, eye.height_px, "panel");
  check(source.width_px, source.height_px, "eye frame");
  check(eye.fov, "eye");
  check(source.fov, "eye frame");
  BraceDisplayParams params{};
  const glm::dvec2 pitch(eye.lens.panel_size_units.x / eye.width_px,
                         -eye.lens.panel_size_units.y / eye.height_px);
  set(params.pitch, pitch.x, pitch.y, eye.lens.tan_per_unit.x, eye.lens.tan_per_unit.y);
  const std::array<double, 3> usable = usable_radii(eye.lens);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const sim::LensChannel& lens = eye.lens.rgb[channel];
    const glm::dvec2 first(0.5 * pitch.x - lens.centre_uv.x * eye.lens.panel_size_units.x,
                           0.5 * pitch.y + lens.centre_uv.y * eye.lens.panel_size_units.y);
    // An infinite radius becomes the largest float: the kernel clamps to it.
    const double usable2 =
        std::min(usable[channel] * usable[channel], double{std::numeric_limits<float>::max()});
    set(params.centre[channel], first.x, first.y, usable2, lens.k[4]);
    set(params.lens[channel], lens.k[0], lens.k[1], lens.k[2], lens.k[3]);
  }
  const double scale_x = source.width_px / source.fov.width();
  const double scale_y = -source.height_px / source.fov.height();
  set(params.source, scale_x, scale_y, -source.fov.left * scale_x - 0.5, -source.fov.top * scale_y - 0.5);
  set(params.source_max, just_below(source.width_px - 1), just_below(source.height_px - 1),
      source.width_px - 0.5, source.height_px - 0.5);
  set(params.fov, eye.fov.left, eye.fov.bottom, eye.fov.right, eye.fov.top);
  params.grid[0] = static_cast<std::uint32_t>(source.width_px);
  const int tiles_across = (eye.width_px + tile_width_px - 1) / tile_width_px;
  params.grid[1] = static_cast<std::uint32_t>(tiles_across * tile_width_px / 4);
  params.grid[2] = static_cast<std::uint32_t>(eye.width_px);
  params.grid[3] = static_cast<std::uint32_t>(eye.height_px);
  const double per_x = eye.scan.per_u / eye.width_px, per_y = eye.scan.per_v / eye.height_px;
  set(params.scan, per_x, per_y, 0.5 * (per_x + per_y) + eye.scan.base, 0.0);
  set_poses(params, {}, Pose{});
  return params;
}

void set_poses(BraceDisplayParams& params, const Pose& world_from_old_eye, const Pose& world_from_new_eye) {
  set_poses(params, world_from_old_eye, ScanEye{world_from_new_eye, world_from_new_eye});
}

void set_poses(BraceDisplayParams& params, const Pose& world_from_old_eye, const ScanEye& new_eye) {
  const Pose old_from_world = inverse(world_from_old_eye);
  set_pose(params.old_from_new, compose(old_from_world, new_eye.world_from_first_line));
  set_pose(params.old_from_last, compose(old_from_world, new_eye.world_from_last_line));
}

std::vector<float> scan_fractions(const PanelEye& eye, const SourcePicture& source) {
  const double usable = sim::usable_radius(eye.lens, sim::Channel::green);
  std::vector<float> fractions;
  fractions.reserve(static_cast<std::size_t>(source.width_px) * static_cast<std::size_t>(source.height_px));
  for (int y = 0; y < source.height_px; ++y)
    for (int x = 0; x < source.width_px; ++x) {
      const glm::dvec2 tangents =
          sim::target_uv_to_tangents(source.fov, {(x + 0.5) / source.width_px, (y + 0.5) / source.height_px});
      const auto uv = sim::tangents_to_panel(eye.lens, sim::Channel::green, usable, tangents);
      fractions.push_back(uv ? static_cast<float>(std::clamp(eye.scan.at(uv->x, uv->y), 0.0, 1.0)) : 0.5f);
    }
  return fractions;
}

std::vector<std::uint32_t> visible_tiles(const PanelEye& eye) {
  const std::array<double, 3> usable = usable_radii(eye.lens);
  std::vector<std::uint32_t> tiles;
  for (int row = 0; row * tile_height_px < eye.height_px; ++row)
    for (int column = 0; column * tile_width_px < eye.width_px; ++column)
      if (tile_visible(eye, usable, column * tile_width_px, row * tile_height_px))
        tiles.push_back(static_cast<std::uint32_t>(column) | static_cast<std::uint32_t>(row) << 16);
  return tiles;
}

}  // namespace brace
