#include "bench/stereo.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "bench/median.hpp"
#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/eye_rig.hpp"
#include "runtime/timeline/cost_source.hpp"

namespace brace {

namespace {

const std::vector<std::string> kParts = {"methods", "shading", "layers", "resolution"};

/// A row's label and the lines of a session that make it.
struct Choice {
  std::string label, lines;
};

const Choice kTwoPass = {"two_pass", "pipeline.stereo = 'two_pass'\n"};
const Choice kLayers = {"layers", "pipeline.stereo = 'layers'\n"};
const Choice kNovelView = {"novel_view", "pipeline.stereo = 'novel_view'\n"};
const Choice kUnlit = {"none", ""};

Choice layers_with(const std::string& label, const std::string& parameters) {
  return {"layers, " + label, kLayers.lines + "[stage.'layers']\n" + parameters};
}

/// As published, then one improvement after the other, then the other ways.
std::vector<Choice> methods() {
  const std::string published = "path_length = 'reference'\nholes = 'none'\n";
  return {layers_with("as published", published),
          layers_with("+ own path lengths", "holes = 'none'\n"),
          layers_with("+ fresh rays", ""),
          layers_with("+ linear", "interpolation = 'linear'\n"),
          layers_with("linear, rgba8", "interpolation = 'linear'\nformat = 'rgba8'\n"),
          layers_with("linear, rgba32f", "interpolation = 'linear'\nformat = 'rgba32f'\n"),
          layers_with("interleave 2", "interleave = 2\n"),
          layers_with("middle", "reference = 'middle'\n"),
          layers_with("middle, linear", "reference = 'middle'\ninterpolation = 'linear'\n"),
          kNovelView,
          {"novel_view, middle", kNovelView.lines + "[stage.'novel_view']\nreference = 'middle'\n"}};
}

Choice random_lights(int samples) {
  return {fmt::format("random_lights {}", samples),
          fmt::format("scene.shading = 'random_lights'\nscene.shading_samples = {}\n", samples)};
}

std::vector<Choice> shading_ladder() {
  return {kUnlit,
          random_lights(0),
          random_lights(4),
          random_lights(16),
          random_lights(64),
          {"shadow_ao", "scene.shading = 'shadow_ao'\n"}};
}

Session stereo_session(const StereoBenchOptions& options, const std::string& volume, const Choice& shading,
                       const Choice& stereo, double scale) {
  const std::string text = fmt::format(
      "device.profile = 'htc-vive'\ndevice.resolution_scale = {}\ntrace.neck = {{ motion = 'still' }}\n"
      "pipeline.skip = 'distance_map'\nscene.volume = '{}'\nscene.transfer_function = '{}'\n"
      "scene.size_m = 1.0\nscene.position = 'front:1.2'\n{}{}",
      scale, volume, options.transfer_function, shading.lines, stereo.lines);
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

ImageRgba8 picture_of(const gpu::Device& device, const EyeRig& rig, std::size_t eye) {
  ImageRgba8 image(rig.headset.eye.width_px, rig.headset.eye.height_px);
  gpu::download_values<Rgba8>(device, rig.eyes[eye].image, image.pixels);
  return image;
}

/// A turn about the volume with one stereo stage.
struct Turn {
  std::vector<double> times_s, model_s, software_s;
  WorkCounts work;
  double right_pixels = 0, layer_mib = 0;
  std::vector<ImageRgba8> left, right;
};

Turn walk_round(const gpu::Device& device, const StereoBenchOptions& options, Session session) {
  EyeRig rig(device, options.data_folder, std::move(session));
  rig.render();
  Turn turn;
  if (is_by_layers(rig.session)) {
    const StereoPlan plan =
        plan_single_pass(device, rig.session, rig.headset, rig.scene->volume.info(), rig.placement);
    turn.layer_mib = static_cast<double>(plan.bytes) / (1024.0 * 1024.0);
  }
  for (int view = 0; view < options.views; ++view) {
    const Pose pose = around(rig.placement, 2.0 * std::numbers::pi * view / options.views);
    const JobOutcome outcome = rig.renderer.render(pose, rig.eyes);
    const double scale = rig.session.device.resolution_scale;
    const WorkCounts full = scale_pixel_work(outcome.work, 1.0 / (scale * scale));
    turn.times_s.push_back(to_s(outcome.device_time));
    turn.model_s.push_back(to_s(evaluate(options.model, JobKind::cast, full)));
    turn.software_s.push_back(to_s(evaluate(options.software_model, JobKind::cast, full)));
    turn.work += outcome.work;
    turn.right_pixels += 0.5 * rig.pixels();
    turn.left.push_back(picture_of(device, rig, 0));
    turn.right.push_back(picture_of(device, rig, 1));
  }
  return turn;
}

double saved(const std::vector<double>& pair_s, const std::vector<double>& two_passes_s) {
  std::vector<double> per_view;
  for (std::size_t i = 0; i < pair_s.size(); ++i)
    per_view.push_back(2.0 - 2.0 * pair_s[i] / two_passes_s[i]);
  return median(std::move(per_view));
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

class Bench {
 public:
  Bench(const gpu::Device& device, const StereoBenchOptions& options, StereoBenchResult& result)
      : device_(device), options_(options), result_(result) {}

  void methods_part() {
    for (const std::string& volume : options_.volumes)
      compare("methods", volume, kUnlit, methods(), options_.resolution_scale);
  }
  void shading_part() {
    for (const std::string& volume : options_.volumes)
      for (const Choice& shading : shading_ladder())
        compare("shading", volume, shading, {kLayers, kNovelView}, options_.ladder_scale);
  }
  void layers_part() {
    std::vector<Choice> counts;
    for (const int layers : {32, 64, 96})
      counts.push_back(layers_with(fmt::format("{}", layers), fmt::format("layers = {}\n", layers)));
    for (const Choice& shading : {kUnlit, random_lights(16)})
      compare("layers", options_.volumes.front(), shading, counts, options_.ladder_scale);
  }
  void resolution_part() {
    for (const double scale : options_.scales)
      for (const Choice& shading : {kUnlit, random_lights(16)})
        compare("resolution", options_.volumes.front(), shading, {kLayers, kNovelView}, scale);
  }

 private:
  void compare(const std::string& part, const std::string& volume, const Choice& shading,
               const std::vector<Choice>& stereo, double scale) {
    if (options_.progress) options_.progress(fmt::format("{}: {}, {}", part, volume, shading.label));
    const Turn twice =
        walk_round(device_, options_, stereo_session(options_, volume, shading, kTwoPass, scale));
    for (const Choice& choice : stereo) {
      const Turn once =
          walk_round(device_, options_, stereo_session(options_, volume, shading, choice, scale));
      StereoBenchRow row{part, volume, shading.label, choice.label, scale};
      row.saved_device = saved(once.times_s, twice.times_s);
      row.saved_model = saved(once.model_s, twice.model_s);
      row.saved_software_model = saved(once.software_s, twice.software_s);
      row.samples_share = ratio(once.work.samples, twice.work.samples);
      row.fetches_share = ratio(once.work.shading_fetches, twice.work.shading_fetches);
      row.texels_per_px = static_cast<double>(once.work.texels) / once.right_pixels;
      row.layer_mib = once.layer_mib;
      for (std::size_t i = 0; i < once.right.size(); ++i) {
        const double dssim = dssim_from_ssim(ssim(once.right[i], twice.right[i]));
        row.dssim_mean += dssim / static_cast<double>(once.right.size());
        row.dssim_left_mean +=
            dssim_from_ssim(ssim(once.left[i], twice.left[i])) / static_cast<double>(once.left.size());
        row.dssim_max = std::max(row.dssim_max, dssim);
      }
      result_.rows.push_back(std::move(row));
    }
  }

  const gpu::Device& device_;
  const StereoBenchOptions& options_;
  StereoBenchResult& result_;
};

}  // namespace

StereoBenchResult bench_stereo(const StereoBenchOptions& options) {
  for (const std::string& part : options.parts)
    if (std::find(kParts.begin(), kParts.end(), part) == kParts.end())
      throw input_error("bench stereo: there is no part '{}'{}; accepted: {}", part,
                        did_you_mean(part, kParts), join(kParts));
  StereoBenchResult result;
  getloadavg(&result.host_load, 1);
  const gpu::Device device(options.device);
  result.device = device.info().name;
  result.driver = device.info().driver;
  result.model = options.model.name;
  result.software_model = options.software_model.name;
  result.views = options.views;
  Bench bench(device, options, result);
  for (const std::string& part : options.parts) {
    if (part == "methods") bench.methods_part();
    if (part == "shading") bench.shading_part();
    if (part == "layers") bench.layers_part();
    if (part == "resolution") bench.resolution_part();
  }
  return result;
}

std::string to_text(const StereoBenchResult& result) {
  std::string text = fmt::format(
      "{} ({}), load {:.2f}; {} views of a turn about the volume, HTC Vive; V = 1 - (T_pair - T_eye) / "
      "T_eye\n",
      result.device, result.driver, result.host_load, result.views);
  std::string part;
  for (const StereoBenchRow& row : result.rows) {
    if (row.part != part)
      text += fmt::format(
          "\n{}\n{:<30}{:<18}{:<28}{:>6}{:>9}{:>17}{:>12}{:>9}{:>9}{:>8}{:>8}{:>9}{:>9}{:>9}\n", row.part,
          "volume", "shading", "stereo", "scale", "V device", "V " + result.software_model,
          "V " + result.model, "samples", "fetches", "texels", "MiB", "DSSIM", "largest", "left");
    part = row.part;
    text += fmt::format(
        "{:<30}{:<18}{:<28}{:>6.2f}{:>9.3f}{:>17.3f}{:>12.3f}{:>8.1f}%{:>8.1f}%{:>8.1f}{:>8.1f}{:>9.5f}{:>9."
        "5f}{:>9.5f}\n",
        row.volume, row.shading, row.stereo, row.resolution_scale, row.saved_device, row.saved_software_model,
        row.saved_model, 100.0 * row.samples_share, 100.0 * row.fetches_share, row.texels_per_px,
        row.layer_mib, row.dssim_mean, row.dssim_max, row.dssim_left_mean);
  }
  return text;
}

std::string to_json(const StereoBenchResult& result) {
  nlohmann::ordered_json json{{"device", result.device},
                              {"driver", result.driver},
                              {"host_load", result.host_load},
                              {"model", result.model},
                              {"software_model", result.software_model},
                              {"views", result.views}};
  for (const StereoBenchRow& row : result.rows)
    json["rows"].push_back({{"part", row.part},
                            {"volume", row.volume},
                            {"shading", row.shading},
                            {"stereo", row.stereo},
                            {"resolution_scale", row.resolution_scale},
                            {"saved_device", row.saved_device},
                            {"saved_model", row.saved_model},
                            {"saved_software_model", row.saved_software_model},
                            {"samples_share", row.samples_share},
                            {"fetches_share", row.fetches_share},
                            {"texels_per_px", row.texels_per_px},
                            {"layer_mib", row.layer_mib},
                            {"dssim_left_mean", row.dssim_left_mean},
                            {"dssim_mean", row.dssim_mean},
                            {"dssim_max", row.dssim_max}});
  return json.dump(2);
}

}  // namespace brace
