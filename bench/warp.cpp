#include "bench/warp.hpp"

#include <array>
#include <cstdlib>
#include <memory>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/median.hpp"
#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/replay.hpp"

namespace brace {

namespace {

struct Motion {
  const char* name;
  Pose moved;  // of the head since the eye frame
};

/// What a quick head does in three display periods.
std::vector<Motion> motions() {
  return {{"none", {}},
          {"rotation 4 deg", {quat_exp({0.0, 0.07, 0.0}), {}}},
          {"translation 3 cm", {{1.0, 0.0, 0.0, 0.0}, {0.03, 0.0, 0.0}}},
          {"both", {quat_exp({0.02, 0.05, 0.0}), {0.02, 0.005, -0.01}}}};
}

struct Rig {
  Rig(const WarpBenchOptions& options, const char* lens)
      : session(parse_session(
            fmt::format("device.profile = 'htc-vive'\ndevice.lens = '{}'\ndevice.resolution_scale = {}\n"
                        "trace.neck = {{ motion = 'still' }}\n"
                        "[scene]\nvolume = 'generator:fractal_vessels:128'\nposition = 'front:0.5'\n"
                        "transfer_function = 'ct-soft-tissue'\nsize_m = 0.6\n",
                        lens, options.resolution_scale),
            "bench", ".", {}, options.stages)),
        headset(make_headset(session, options.data_folder)) {}

  Session session;
  Headset headset;
};

double time_of(PanelDisplay& display, const PanelImage& image, int repetitions) {
  std::vector<double> ns;
  for (int i = -2; i < repetitions; ++i) {  // two to warm up
    const JobOutcome outcome = display.show(image);
    if (i >= 0) ns.push_back(static_cast<double>(outcome.device_time.count()));
  }
  return median(ns);
}

double dssim(const PanelPair& shown, const PanelPair& ideal, const Headset& headset) {
  double sum = 0.0;
  for (const sim::Eye eye : sim::all_eyes) {
    const auto i = static_cast<std::size_t>(eye);
    sum += 0.5 * dssim_from_ssim(ssim(shown[i], ideal[i], visible_pixels(headset, eye)));
  }
  return sum;
}

}  // namespace

WarpBenchResult bench_warp(const WarpBenchOptions& options) {
  WarpBenchResult result;
  getloadavg(&result.host_load, 1);
  const gpu::Device device(options.device);
  result.device = device.info().name;
  result.repetitions = options.repetitions;
  const Rig rig(options, "profile"), no_lens(options, "none");
  const VolumePlacement placement = place_volume(rig.session.scene, Pose{});
  const std::unique_ptr<SceneOnDevice> scene =
      load_scene(device, rig.session, {.data_folder = options.data_folder}, rig.headset, placement);
  EyeRenderer renderer(device, rig.session, rig.headset, *scene, placement, options.data_folder,
                       EyeRenderer::Counting::off);
  const EyePair eyes = make_eye_pair(device, rig.headset.eye);
  const EyePair ideal_eyes = make_eye_pair(device, rig.headset.eye);
  const auto with = [&](const char* warp) {
    PipelineStage stage{options.stages.find("warp", warp, "bench"), {}};
    for (const StageParameter& parameter : stage.stage.parameters)
      stage.values.push_back(parameter.default_value);
    return stage;
  };

  (void)renderer.render(Pose{}, eyes);
  std::vector<double> cast_ns;
  for (int i = 0; i < 3; ++i)
    cast_ns.push_back(static_cast<double>(renderer.render(Pose{}, eyes).device_time.count()));
  PanelDisplay copy(device, no_lens.headset, with("none"), options.data_folder);
  const double copy_ns = time_of(copy, {eyes, Pose{}, Pose{}}, options.repetitions);
  result.copy_ms = copy_ns * 1e-6;
  result.cast_ms = median(cast_ns) * 1e-6;

  PanelDisplay ideal_display(device, rig.headset, with("none"), options.data_folder);
  for (const Motion& motion : motions()) {
    (void)renderer.render(motion.moved, ideal_eyes);
    ideal_display.show({ideal_eyes, Pose{}, Pose{}});
    const PanelPair ideal = ideal_display.read();
    for (const char* warp : {"none", "quad", "grid"}) {
      // The cost without a lens, as the copy's; the picture with it.
      PanelDisplay bare(device, no_lens.headset, with(warp), options.data_folder);
      PanelDisplay display(device, rig.headset, with(warp), options.data_folder);
      const double ns = time_of(bare, {eyes, Pose{}, motion.moved}, options.repetitions);
      display.show({eyes, Pose{}, motion.moved});
      WarpBenchRow row{warp, motion.name, ns / copy_ns, ns / median(cast_ns), 0, 0, 0};
      row.dssim = dssim(display.read(), ideal, rig.headset);
      const auto pixels = static_cast<double>(display.work().texels);
      row.filled_percent = 100.0 * static_cast<double>(display.counted().filled) / pixels;
      row.uncovered_percent = 100.0 * static_cast<double>(display.counted().uncovered) / pixels;
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

std::string to_text(const WarpBenchResult& result) {
  std::string text =
      fmt::format("warps on {}; {} repetitions, load {:.2f}; copy {:.3f} ms, cast {:.1f} ms\n\n",
                  result.device, result.repetitions, result.host_load, result.copy_ms, result.cast_ms);
  text += fmt::format("{:<18}{:<8}{:>10}{:>10}{:>10}{:>10}{:>12}\n", "head moved by", "warp", "x copy",
                      "x cast", "DSSIM", "filled", "uncovered");
  for (const WarpBenchRow& row : result.rows)
    text += fmt::format("{:<18}{:<8}{:>10.3f}{:>10.4f}{:>10.5f}{:>8.3f} %{:>10.3f} %\n", row.motion, row.warp,
                        row.over_copy, row.over_cast, row.dssim, row.filled_percent, row.uncovered_percent);
  text += "\ntargets: quad at most 1.2 x the copy, grid at most 3 x\n";
  return text;
}

std::string to_json(const WarpBenchResult& result) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const WarpBenchRow& row : result.rows)
    rows.push_back(nlohmann::ordered_json{{"warp", row.warp},
                                          {"motion", row.motion},
                                          {"over_copy", row.over_copy},
                                          {"over_cast", row.over_cast},
                                          {"dssim", row.dssim},
                                          {"filled_percent", row.filled_percent},
                                          {"uncovered_percent", row.uncovered_percent}});
  return nlohmann::ordered_json{{"device", result.device},
                                {"host_load", result.host_load},
                                {"copy_ms", result.copy_ms},
                                {"cast_ms", result.cast_ms},
                                {"rows", rows}}
      .dump(2);
}

}  // namespace brace
