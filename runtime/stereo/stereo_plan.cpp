#include "runtime/stereo/stereo_plan.hpp"

#include <algorithm>
#include <limits>

#include <fmt/core.h>

#include "base/error.hpp"

namespace brace {

namespace {

void set_grid(StereoPlan& plan, const StereoGeometry& geometry, int width_px, int height_px) {
  plan.margins =
      ray_margins(geometry, width_px, height_px, {plan.near_m, std::numeric_limits<double>::infinity()});
  // Behind what a whole picture beside the first eye's own could show lies nothing worth rays.
  plan.margins.left = std::min(plan.margins.left, width_px);
  plan.margins.right = std::min(plan.margins.right, width_px);
  plan.across = plan.margins.left + width_px + plan.margins.right;
  plan.down = plan.margins.top + height_px + plan.margins.bottom;
}

std::string format_name(int bytes_per_texel) {
  return bytes_per_texel == 4 ? "rgba8" : bytes_per_texel == 8 ? "rgba16f" : "rgba32f";
}

/// What would fit, for the message: the most layers in this format, or why none do.
std::string fitting(const StereoPlan& plan, std::uint64_t bytes_max) {
  const int bytes_per_texel = plan.settings.bytes_per_texel;
  const std::uint64_t fits = bytes_max / layer_bytes(plan.columns, plan.down, 1, bytes_per_texel);
  std::string text = fits >= 2 ? fmt::format("stage.\"layers\".layers = {}", fits) : "";
  const std::uint64_t fits_small = bytes_max / layer_bytes(plan.columns, plan.down, 1, 4);
  if (bytes_per_texel > 4 && fits_small >= static_cast<std::uint64_t>(plan.layers)) {
    text += fmt::format("{}stage.\"layers\".format = \"rgba8\"", text.empty() ? "" : ", ");
  }
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

}  // namespace

int layers_for(const StereoSettings& settings, const StereoGeometry& geometry, double range_px) {
  return interference_free_layers(range_px * settings.columns_per_pixel(),
                                  settings.columns_per_ray(geometry.pixels_per_ray));
}

StereoPlan plan_stereo(const StereoSettings& settings, const StereoGeometry& geometry, int width_px,
                       int height_px, double radius_m, const StereoMemory& memory) {
  if (settings.interpolates && settings.interleave > 1) {
    throw input_error(
        "stage stereo/layers: interpolation = 'linear' wants every ray, interleave = {} takes one of {}; "
        "accepted: "
        "one of the two",
        settings.interleave, settings.interleave);
  }
  StereoPlan plan;
  plan.settings = settings;
  plan.width_px = width_px;
  plan.height_px = height_px;
  plan.near_m = settings.near_m;
  const double range_px = disparity_range_of_sphere_px(geometry.optics, radius_m, settings.near_m);
  if (range_px < 1.0) {
    plan.layers_left_out = true;
    plan.summary = fmt::format(
        "from {:.3g} m on the disparity varies by {:.3g} px over the volume: no layers, the right eye's "
        "picture "
        "is the left's, shifted",
        plan.near_m, range_px);
    set_grid(plan, geometry, width_px, height_px);
    return plan;
  }
  plan.layers = settings.layers;
  plan.columns = columns_of(settings, width_px);
  if (settings.layers == 0) {
    plan.layers = layers_for(settings, geometry, range_px);
  } else {
    const double most_columns = settings.layers * settings.columns_per_ray(geometry.pixels_per_ray) - 1.0;
    const double most_px = most_columns / settings.columns_per_pixel();
    if (most_px < 0.5) {
      throw input_error(
          "stage stereo/layers: layers = {} leaves no disparity to work with; accepted: 0 (automatic) or at "
          "least 2",
          settings.layers);
    }
    plan.near_m = near_plane_m(geometry.optics, radius_m, most_px);
  }
  set_grid(plan, geometry, width_px, height_px);
  plan.bytes = layer_bytes(plan.columns, plan.down, plan.layers, settings.bytes_per_texel);
  check_memory(plan, memory);
  plan.summary = fmt::format(
      "{} layers of {} x {} {} in {}, {:.2f} MiB; near plane {:.3f} m before the volume's bounding sphere",
      plan.layers, plan.columns, plan.down, plan.columns == width_px ? "px" : "texels",
      format_name(settings.bytes_per_texel), static_cast<double>(plan.bytes) / (1024.0 * 1024.0),
      plan.near_m);
  return plan;
}

}  // namespace brace
