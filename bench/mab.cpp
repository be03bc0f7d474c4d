#include "bench/mab.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "bench/median.hpp"
#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/eye_rig.hpp"
#include "runtime/replay/gaze_source.hpp"
#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/replay.hpp"

namespace brace {

namespace {

constexpr std::array maps = {"radius", "lens", "eccentricity", "lens_eccentricity"};
/// Rays over the pixels: the same for every map, so that no curve is judged between its points.
constexpr std::array shares = {1.0, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.22, 0.16, 0.12};

/// As many levels below a ray per pixel for every map.
const char* const levels_text =
    "scale_0 = 1.0\nscale_1 = 0.7\nscale_2 = 0.5\nscale_3 = 0.3\n"
    "anchor_1 = 0.5\nanchor_2 = 0.75\nanchor_3 = 1.0\n";

struct Scene {
  std::string profile, volume;
  double resolution_scale;
  /// Vessels to look at; or fog from the eye on, where every ray is as much work.
  const char* look = "transfer_function = 'ct-bone'\nposition = 'front:0.45'";
};

constexpr const char* fog = "transfer_function = 'ct-soft-tissue'\nposition = 'front:0.6'";

Session session_of(const MabBenchOptions& options, const Scene& scene, const std::string& rays,
                   const std::string& map, const std::string& scheme) {
  const std::string text = fmt::format(
      "device.profile = '{}'\ndevice.resolution_scale = {}\ntrace.neck = {{ motion = 'still' }}\n"
      "pipeline.rays = '{}'\npipeline.skip = 'distance_map'\n"
      "[scene]\nvolume = '{}'\n{}\nsize_m = 1.0\n"
      "[stage.mab]\nmap = '{}'\nscheme = '{}'\n{}",
      scene.profile, scene.resolution_scale, rays, scene.volume, scene.look, map, scheme, levels_text);
  return parse_session(text, "bench", ".", {}, options.stages);
}

MabErrorRow compare(const PanelPair& shown, const PanelPair& ideal, const Headset& headset) {
  MabErrorRow row;
  GazeWeights weights(headset);
  for (const sim::Eye eye : sim::all_eyes) {
    const auto i = static_cast<std::size_t>(eye);
    const std::vector<std::uint8_t> visible = visible_pixels(headset, eye);
    row.dssim += 0.5 * dssim_from_ssim(ssim(shown[i], ideal[i], visible));
    row.weighted_rmse += 0.5 * weighted_rmse(shown[i], ideal[i], weights.of(eye, sim::straight_ahead));
  }
  return row;
}

/// Qualities on both sides of a share of the rays, as near to it as a plan's steps come, the larger first:
/// between them an error is as good as straight. Where one is farther off than the other map's, curves that
/// are hollow make a map look worse than it is.
std::vector<double> qualities_around(const MabPlan& plan, double share, double pixels) {
  const auto all = static_cast<double>(plan.rays(plan.steps())), wanted = share * pixels;
  double above = all + 1.0;
  for (int step = 0; step <= plan.steps(); ++step)
    if (const auto rays = static_cast<double>(plan.rays(step)); rays > wanted) above = std::min(above, rays);
  std::vector<double> qualities;
  if (above <= all) qualities.push_back(above / all);
  qualities.push_back(std::min(wanted / all, 1.0));
  return qualities;
}

void measure_errors(const gpu::Device& device, const MabBenchOptions& options, const Scene& scene,
                    std::vector<MabErrorRow>& rows) {
  EyeRig full(device, options.data_folder, session_of(options, scene, "full_rate", "radius", "compact"));
  const PipelineStage no_warp{options.stages.find("warp", "none", "bench"), {}};
  PanelDisplay display(device, full.headset, no_warp, options.data_folder);
  const auto shown = [&](const EyePair& eyes) {
    display.show({eyes, Pose{}, Pose{}});
    return display.read();
  };
  full.render();
  const PanelPair ideal = shown(full.eyes);
  for (const char* map : maps) {
    options.progress(fmt::format("mab: {} {} {}", scene.profile, scene.volume, map));
    EyeRig mab(device, options.data_folder, session_of(options, scene, "mab", map, "compact"));
    const std::optional<MabPlan> plan = plan_mab(mab.session, mab.headset);
    std::vector<double> qualities;
    for (const double share : shares)
      for (const double quality : qualities_around(*plan, share, mab.pixels()))
        qualities.push_back(quality);
    for (const double quality : qualities) {
      const double ray_share = static_cast<double>(plan->rays(plan->step_for(quality))) / mab.pixels();
      if (!rows.empty() && rows.back().map == map && rows.back().profile == scene.profile &&
          rows.back().volume == scene.volume && rows.back().ray_share == ray_share)
        continue;
      mab.render(quality);
      MabErrorRow row = compare(shown(mab.eyes), ideal, full.headset);
      row.profile = scene.profile;
      row.volume = scene.volume;
      row.map = map;
      row.ray_share = ray_share;
      rows.push_back(std::move(row));
    }
  }
}

using Curve = std::vector<const MabErrorRow*>;

/// An error of one curve at a share of the rays; NaN beyond its ends. The curve falls in its share.
double error_at(const Curve& curve, double MabErrorRow::*error, double share) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const MabErrorRow &more = *curve[i - 1], &fewer = *curve[i];
    if (share > more.ray_share || share < fewer.ray_share) continue;
    const double t = (share - fewer.ray_share) / std::max(more.ray_share - fewer.ray_share, 1e-12);
    return fewer.*error + t * (more.*error - fewer.*error);
  }
  return std::nan("");
}

struct Ratio {
  double mean = std::nan(""), worst = 0.0;
};

/// Of the errors of two curves at equal rays.
Ratio ratio_of(const Curve& one, const Curve& other, double MabErrorRow::*error) {
  Ratio ratio;
  double sum = 0.0;
  int count = 0;
  for (const double share : shares) {
    if (share == 1.0) continue;
    const double of_one = error_at(one, error, share), of_other = error_at(other, error, share);
    if (!std::isfinite(of_one) || !(of_other > 0.0)) continue;
    sum += of_one / of_other;
    ratio.worst = std::max(ratio.worst, of_one / of_other);
    ++count;
  }
  if (count > 0) ratio.mean = sum / count;
  return ratio;
}

MabMapRow compare_maps(const std::vector<MabErrorRow>& errors, const Scene& scene) {
  const auto curve_of = [&](const char* map) {
    Curve curve;
    for (const MabErrorRow& row : errors)
      if (row.profile == scene.profile && row.volume == scene.volume && row.map == map) curve.push_back(&row);
    return curve;
  };
  const Curve radius = curve_of("radius");
  const Ratio dssim = ratio_of(curve_of("lens"), radius, &MabErrorRow::dssim);
  const Ratio weighted = ratio_of(curve_of("lens_eccentricity"), radius, &MabErrorRow::weighted_rmse);
  return {scene.profile, scene.volume, dssim.mean, dssim.worst, weighted.mean, weighted.worst};
}

void measure_times(const gpu::Device& device, const MabBenchOptions& options, const Scene& scene,
                   std::vector<MabTimeRow>& rows) {
  EyeRig full(device, options.data_folder, session_of(options, scene, "full_rate", "radius", "compact"));
  for (const char* map : {"radius", "lens_eccentricity"})
    for (const char* scheme : {"compact", "discard"}) {
      options.progress(fmt::format("mab: times, {} {}", map, scheme));
      EyeRig mab(device, options.data_folder, session_of(options, scene, "mab", map, scheme));
      std::vector<double> full_ns, mab_ns;
      double full_rays = 0, mab_rays = 0;
      for (int i = -2; i < options.repetitions; ++i) {  // two to warm up
        const JobOutcome by_pixel = full.render(), by_atlas = mab.render();
        full_rays = static_cast<double>(by_pixel.work.rays);
        mab_rays = static_cast<double>(by_atlas.work.rays);
        if (i < 0) continue;
        full_ns.push_back(static_cast<double>(by_pixel.device_time.count()));
        mab_ns.push_back(static_cast<double>(by_atlas.device_time.count()));
      }
      rows.push_back({map, scheme, mab_rays / full_rays, median(mab_ns) / median(full_ns)});
    }
}

MabAtlasRow pack(const MabBenchOptions& options, const std::string& profile) {
  const sim::DeviceProfile device = sim::find_device_profile(options.data_folder / "devices", profile);
  std::vector<AtlasRect> levels;
  MabAtlasRow row{profile, 0, 0, 0};
  for (const double scale : {0.9, 0.7, 0.5, 0.3}) {
    levels.push_back({0, 0, static_cast<int>(std::lround(device.panel_width_px * scale)),
                      static_cast<int>(std::lround(device.panel_height_px * scale))});
    row.used += std::int64_t{levels.back().width} * levels.back().height;
  }
  const Atlas packed = pack_atlas(levels), fixed = fixed_atlas(levels);
  row.packed = std::int64_t{packed.width} * packed.height;
  row.fixed = std::int64_t{fixed.width} * fixed.height;
  return row;
}

}  // namespace

MabBenchResult bench_mab(const MabBenchOptions& options) {
  const MabBenchOptions all;
  for (const std::string& part : options.parts) {
    if (std::find(all.parts.begin(), all.parts.end(), part) == all.parts.end())
      throw input_error("bench mab: --part {}; accepted: {}", part, join(all.parts));
  }
  MabBenchResult result;
  getloadavg(&result.host_load, 1);
  const gpu::Device device(options.device);
  result.device = device.info().name;
  result.repetitions = options.repetitions;
  const auto wants = [&](const char* part) {
    return std::find(options.parts.begin(), options.parts.end(), part) != options.parts.end();
  };
  if (wants("atlases"))
    for (const std::string& profile : options.profiles)
      result.atlases.push_back(pack(options, profile));
  if (wants("errors"))
    for (const std::string& profile : options.profiles)
      for (const std::string& volume : options.volumes) {
        const Scene scene{profile, volume, options.resolution_scale};
        measure_errors(device, options, scene, result.errors);
        result.maps.push_back(compare_maps(result.errors, scene));
      }
  if (wants("times"))
    measure_times(device, options,
                  {options.profiles.front(), options.volumes.front(), 2 * options.resolution_scale, fog},
                  result.times);
  if (wants("controls")) result.controls = mab_control_rows(options.stages);
  return result;
}

}  // namespace brace
