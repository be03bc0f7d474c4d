#include "runtime/stereo/stereo_plan.hpp"

#include <algorithm>
#include <limits>

#include <fmt/core.h>
#include <glm/gtc/quaternion.hpp>

#include "base/error.hpp"

namespace brace {

namespace {

/// Which of the rays beside the reference's picture any of the composed ones shows.
void set_grid(StereoPlan& plan, const std::vector<StereoPair>& pairs) {
  plan.across = plan.width_px;
  plan.down = plan.height_px;
  if (plan.levels > 0) return;
  for (const StereoPair& pair : pairs) {
    RayMargins needed = ray_margins(pair.geometry, plan.width_px, plan.height_px,
                                    {plan.near_m, std::numeric_limits<double>::infinity()});
    if (pair.is_mirrored) std::swap(needed.left, needed.right);
    // Behind what a whole picture beside the first eye's own could show lies nothing worth rays.
    plan.margins.left = std::max(plan.margins.left, std::min(needed.left, plan.width_px));
    plan.margins.right = std::max(plan.margins.right, std::min(needed.right, plan.width_px));
    plan.margins.top = std::max(plan.margins.top, needed.top);
    plan.margins.bottom = std::max(plan.margins.bottom, needed.bottom);
  }
  plan.across += plan.margins.left + plan.margins.right;
  plan.down += plan.margins.top + plan.margins.bottom;
}

std::string format_name(int bytes_per_texel) {
  return bytes_per_texel == 4 ? "rgba8" : bytes_per_texel == 8 ? "rgba16f" : "rgba32f";
}

/// What would fit, for the message: the most layers in this format, or why none do. Other pictures' layers
/// follow from the first's in proportion.
std::string fitting(const StereoPlan& plan, std::uint64_t bytes_max) {
  const auto bytes_per_texel = static_cast<std::uint64_t>(plan.settings.bytes_per_texel);
  const auto layers = static_cast<std::uint64_t>(plan.layers);
  const std::uint64_t fits = bytes_max / ((plan.bytes + layers - 1) / layers);
  std::string text = fits >= 2 ? fmt::format("stage.\"layers\".layers = {}", fits) : "";
  if (bytes_per_texel > 4 && plan.bytes / bytes_per_texel * 4 <= bytes_max)
    text += fmt::format("{}stage.\"layers\".format = \"rgba8\"", text.empty() ? "" : ", ");
  return text + (text.empty() ? "" : ", ") + "a smaller device.resolution_scale, or stereo/two_pass";
}

void check_memory(const StereoPlan& plan, const StereoMemory& memory) {
  const std::uint64_t bytes_max = std::min(memory.binding_bytes_max, memory.memory_bytes / 2);
  if (plan.bytes <= bytes_max) return;
  throw input_error(
      "stage stereo/layers: {} layers of {} x {} texels in {} take {} bytes, and the device has {} for them; "
      "what "
      "fits: {}",
      plan.layers, plan.columns, plan.down, format_name(plan.settings.bytes_per_texel), plan.bytes, bytes_max,
      fitting(plan, bytes_max));
}

int columns_of(const StereoSettings& settings, int width_px) {
  if (settings.interpolates) return 2 * width_px;
  // Rows are shifted by up to interleave - 1 pixels.
  return (width_px + 2 * (settings.interleave - 1)) / settings.interleave;
}

void set_pictures(StereoPlan& plan, const std::vector<StereoPair>& pairs, double radius_m) {
  std::uint64_t texels = 0;
  for (const StereoPair& pair : pairs) {
    StereoPicture picture{.pair = pair, .columns = columns_of(plan.settings, pair.width_px)};
    const double range_px = disparity_range_of_sphere_px(pair.geometry.optics, radius_m, plan.near_m);
    if (!plan.layers_left_out)
      picture.layers =
          plan.pictures.empty() ? plan.layers : layers_for(plan.settings, pair.geometry, range_px);
    const RayMargins& margins = plan.margins;
    picture.left = pair.is_mirrored ? margins.right : margins.left;
    picture.top = margins.top;
    picture.across = margins.left + pair.width_px + margins.right;
    picture.down = margins.top + pair.height_px + margins.bottom;
    picture.first_texel = texels;
    picture.first_ray = plan.rays;
    texels += layer_bytes(picture.columns, picture.down, picture.layers, 1);
    plan.rays += static_cast<std::uint64_t>(picture.across) * static_cast<std::uint64_t>(picture.down);
    plan.pictures.push_back(picture);
  }
  plan.bytes = texels * static_cast<std::uint64_t>(plan.settings.bytes_per_texel);
}

/// The near plane of the number of layers that the session gives.
double near_of_layers(const StereoSettings& settings, const StereoGeometry& geometry, double radius_m) {
  const double most_columns = settings.layers * settings.columns_per_ray(geometry.pixels_per_ray) - 1.0;
  const double most_px = most_columns / settings.columns_per_pixel();
  if (most_px < 0.5) {
    throw input_error(
        "stage stereo/layers: layers = {} leaves no disparity to work with; accepted: 0 (automatic) or at "
        "least 2",
        settings.layers);
  }
  return near_plane_m(geometry.optics, radius_m, most_px);
}

std::string layers_text(const StereoPlan& plan) {
  std::string text =
      fmt::format("{} layers of {} x {} {} in {}", plan.layers, plan.columns, plan.pictures.front().down,
                  plan.columns == plan.width_px && plan.levels == 0 ? "px" : "texels",
                  format_name(plan.settings.bytes_per_texel));
  if (plan.settings.from_middle) text += ", for each eye";
  if (plan.levels > 0) text += fmt::format(", for the finest of {} levels", plan.levels);
  return text + fmt::format("{}, {:.2f} MiB; near plane {:.3f} m before the volume's bounding sphere",
                            plan.pictures.size() > 1 ? ", in all" : "",
                            static_cast<double>(plan.bytes) / (1024.0 * 1024.0), plan.near_m);
}

void check_settings(const StereoSettings& settings) {
  if (!settings.interpolates || settings.interleave == 1) return;
  throw input_error(
      "stage stereo/layers: interpolation = 'linear' wants every ray, interleave = {} takes one of {}; "
      "accepted: "
      "one of the two",
      settings.interleave, settings.interleave);
}

}  // namespace

EyeView middle_of(const EyeViews& eyes) {
  EyeView middle = eyes.left;
  const Pose &left = eyes.left.world_from_eye, &right = eyes.right.world_from_eye;
  middle.world_from_eye.position = 0.5 * (left.position + right.position);
  middle.world_from_eye.orientation = glm::slerp(left.orientation, right.orientation, 0.5);
  return middle;
}

StereoPair stereo_pair(const EyeView& reference, const EyeView& composed, bool is_mirrored) {
  const EyeViews pair = is_mirrored ? mirrored({reference, composed}) : EyeViews{reference, composed};
  const EyeView& of = pair.right;
  return {stereo_geometry(pair.left, pair.right),
          of.width_px,
          of.height_px,
          is_mirrored,
          {of.tan_left, of.tan_top, (of.tan_right - of.tan_left) / of.width_px,
           (of.tan_bottom - of.tan_top) / of.height_px}};
}

int layers_for(const StereoSettings& settings, const StereoGeometry& geometry, double range_px) {
  return interference_free_layers(range_px * settings.columns_per_pixel(),
                                  settings.columns_per_ray(geometry.pixels_per_ray));
}

StereoPlan plan_stereo(const StereoSettings& settings, const std::vector<StereoPair>& pairs, double radius_m,
                       const StereoMemory& memory, int levels) {
  BRACE_CHECK(!pairs.empty());
  check_settings(settings);
  const StereoPair& first = pairs.front();
  const StereoGeometry& geometry = first.geometry;
  StereoPlan plan;
  plan.settings = settings;
  plan.levels = levels;
  plan.width_px = first.width_px;
  plan.height_px = first.height_px;
  plan.near_m = settings.near_m;
  const double range_px = disparity_range_of_sphere_px(geometry.optics, radius_m, settings.near_m);
  plan.layers_left_out = range_px < 1.0 && levels == 0;
  if (!plan.layers_left_out) {
    if (settings.layers != 0) plan.near_m = near_of_layers(settings, geometry, radius_m);
    plan.layers = settings.layers != 0 ? settings.layers : layers_for(settings, geometry, range_px);
    plan.columns = columns_of(settings, first.width_px);
  }
  set_grid(plan, pairs);
  set_pictures(plan, pairs, radius_m);
  if (plan.layers_left_out) {
    plan.summary = fmt::format(
        "from {:.3g} m on the disparity varies by {:.3g} px over the volume: no layers, {} the {}, shifted",
        plan.near_m, range_px, settings.from_middle ? "the eyes' pictures are" : "the right eye's picture is",
        settings.from_middle ? "one from between them" : "left's");
    return plan;
  }
  check_memory(plan, memory);
  plan.summary = layers_text(plan);
  return plan;
}

}  // namespace brace
