#include "bench/stereo.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/eye_rig.hpp"
#include "bench/median.hpp"
#include "runtime/metrics/image_error.hpp"

namespace brace {

namespace {

Session stereo_session(const StereoBenchOptions& options, const std::string& volume,
                       const std::string& shading, const std::string& stereo) {
  const std::string text = fmt::format(
      "device.profile = 'htc-vive'\ndevice.resolution_scale = {}\ntrace.neck = {{ motion = 'still' }}\n"
      "pipeline.skip = 'distance_map'\npipeline.stereo = '{}'\n"
      "[scene]\nvolume = '{}'\ntransfer_function = '{}'\nshading = '{}'\nsize_m = 1.0\nposition = "
      "'front:1.2'\n",
      options.resolution_scale, stereo, volume, options.transfer_function, shading);
  return parse_session(text, "bench", ".", {}, options.stages);
}

/// A head that has walked round the volume and looks at it.
Pose around(const VolumePlacement& placement, double turn_rad) {
  const glm::dquat turn = quat_exp({0.0, turn_rad, 0.0});
  const glm::dvec3 centre = placement.world_from_volume.position;
  Pose pose;
  pose.orientation = turn;
  pose.position = centre + turn * (-centre);
  return pose;
}

ImageRgba8 right_picture(const gpu::Device& device, const EyeRig& rig) {
  ImageRgba8 image(rig.headset.eye.width_px, rig.headset.eye.height_px);
  gpu::download_values<Rgba8>(device, rig.eyes[1].image, image.pixels);
  return image;
}

/// A turn about the volume with one stereo stage.
struct Turn {
  std::vector<double> times_s, model_s, samples;
  std::vector<ImageRgba8> right;
};

Turn walk_round(const gpu::Device& device, const StereoBenchOptions& options, Session session) {
  EyeRig rig(device, options.data_folder, std::move(session));
  rig.render();
  Turn turn;
  for (int view = 0; view < options.views; ++view) {
    const Pose pose = around(rig.placement, 2.0 * std::numbers::pi * view / options.views);
    const JobOutcome outcome = rig.renderer.render(pose, rig.eyes);
    turn.times_s.push_back(to_s(outcome.device_time));
    turn.model_s.push_back(to_s(evaluate(options.model, JobKind::cast, outcome.work)));
    turn.samples.push_back(static_cast<double>(outcome.work.samples));
    turn.right.push_back(right_picture(device, rig));
  }
  return turn;
}

double saved(const std::vector<double>& pair_s, const std::vector<double>& two_passes_s) {
  std::vector<double> per_view;
  for (std::size_t i = 0; i < pair_s.size(); ++i)
    per_view.push_back(2.0 - 2.0 * pair_s[i] / two_passes_s[i]);
  return median(std::move(per_view));
}

double total(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values)
    sum += value;
  return sum;
}

}  // namespace

StereoBenchResult bench_stereo(const StereoBenchOptions& options) {
  StereoBenchResult result;
  getloadavg(&result.host_load, 1);
  const gpu::Device device(options.device);
  result.device = device.info().name;
  result.driver = device.info().driver;
  result.model = options.model.name;
  result.views = options.views;
  for (const std::string& volume : options.volumes) {
    for (const char* shading : {"none", "phong"}) {
      const Turn twice = walk_round(device, options, stereo_session(options, volume, shading, "two_pass"));
      for (const char* stereo : {"layers", "novel_view"}) {
        const Turn once = walk_round(device, options, stereo_session(options, volume, shading, stereo));
        StereoBenchRow row{volume, shading, stereo};
        row.saved_device = saved(once.times_s, twice.times_s);
        row.saved_model = saved(once.model_s, twice.model_s);
        row.samples_share = total(once.samples) / total(twice.samples);
        for (std::size_t i = 0; i < once.right.size(); ++i) {
          const double dssim = dssim_from_ssim(ssim(once.right[i], twice.right[i]));
          row.dssim_mean += dssim / static_cast<double>(once.right.size());
          row.dssim_max = std::max(row.dssim_max, dssim);
        }
        result.rows.push_back(std::move(row));
      }
    }
  }
  return result;
}

std::string to_text(const StereoBenchResult& result) {
  std::string text = fmt::format(
      "{} ({}), load {:.2f}; {} views of a turn about the volume, HTC Vive; V = 1 - (T_pair - T_eye) / "
      "T_eye\n\n",
      result.device, result.driver, result.host_load, result.views);
  text += fmt::format("{:<32}{:<8}{:<12}{:>10}{:>14}{:>10}{:>12}{:>12}\n", "volume", "shading", "stereo",
                      "V device", "V " + result.model, "samples", "DSSIM mean", "max");
  for (const StereoBenchRow& row : result.rows)
    text += fmt::format("{:<32}{:<8}{:<12}{:>10.3f}{:>14.3f}{:>9.1f}%{:>12.5f}{:>12.5f}\n", row.volume,
                        row.shading, row.stereo, row.saved_device, row.saved_model, 100.0 * row.samples_share,
                        row.dssim_mean, row.dssim_max);
  return text;
}

std::string to_json(const StereoBenchResult& result) {
  nlohmann::ordered_json json{{"device", result.device},
                              {"driver", result.driver},
                              {"host_load", result.host_load},
                              {"model", result.model},
                              {"views", result.views}};
  for (const StereoBenchRow& row : result.rows)
    json["rows"].push_back({{"volume", row.volume},
                            {"shading", row.shading},
                            {"stereo", row.stereo},
                            {"saved_device", row.saved_device},
                            {"saved_model", row.saved_model},
                            {"samples_share", row.samples_share},
                            {"dssim_mean", row.dssim_mean},
                            {"dssim_max", row.dssim_max}});
  return json.dump(2);
}

}  // namespace brace
