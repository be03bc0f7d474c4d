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
#include "runtime/replay/scene_activation.hpp"

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

/// A warp stage with parameters of its own.
struct Variant {
  std::string label, warp;
  std::vector<std::pair<const char*, double>> numbers{};
  std::vector<std::pair<const char*, const char*>> choices{};
};

std::vector<Variant> variants() {
  std::vector<Variant> all = {{"none", "none"},
                              {"quad", "quad"},
                              {"grid", "grid"},
                              {"grid, search by four", "grid", {}, {{"search", "four"}}},
                              {"volumetric", "volumetric"}};
  for (const double steps : {4.0, 16.0, 32.0, 128.0})
    all.push_back({fmt::format("volumetric, {:g} steps", steps),
                   "volumetric",
                   {{"steps", steps}},
                   {{"sampling", "uniform"}}});
  for (const double layers : {2.0, 8.0})
    all.push_back({fmt::format("volumetric, {:g} layers", layers), "volumetric", {{"layers", layers}}});
  all.push_back({"volumetric, nearest", "volumetric", {}, {{"filter", "nearest"}}});
  all.push_back({"volumetric, equal", "volumetric", {}, {{"layering", "equal"}}});
  return all;
}

PipelineStage stage_of(const Variant& variant, const StageRegistry& stages) {
  PipelineStage stage{stages.find("warp", variant.warp, "bench"), {}};
  for (const StageParameter& parameter : stage.stage.parameters)
    stage.values.push_back(parameter.default_value);
  for (const auto& [name, value] : variant.numbers)
    stage.set(name, value);
  for (const auto& [name, choice] : variant.choices)
    stage.set_choice(name, choice);
  return stage;
}

Session warp_session(const WarpBenchOptions& options, const char* lens) {
  return parse_session(
      fmt::format("device.profile = 'htc-vive'\ndevice.lens = '{}'\ndevice.resolution_scale = {}\n"
                  "trace.neck = {{ motion = 'still' }}\n"
                  "[scene]\nvolume = 'generator:fractal_vessels:128'\nposition = 'front:0.5'\n"
                  "transfer_function = 'ct-soft-tissue'\nsize_m = 0.6\n",
                  lens, options.resolution_scale),
      "bench", ".", {}, options.stages);
}

/// What the warps of a bench share: a scene, the display with its lens and without.
struct WarpRig {
  WarpRig(const gpu::Device& on, const WarpBenchOptions& with)
      : device(on),
        options(with),
        session(warp_session(with, "profile")),
        headset(make_headset(session, with.data_folder)),
        no_lens(make_headset(warp_session(with, "none"), with.data_folder)),
        placement(place_volume(session.scene, Pose{})),
        scene(load_scene(on, session, {.data_folder = with.data_folder}, headset, placement)),
        no_warp(stage_of({"none", "none"}, with.stages)) {}

  PanelDisplay display(const Headset& of, const PipelineStage& warp) const {
    return {device,
            of,
            warp,
            no_warp,
            scene_activation(device, session, of, *scene, placement),
            options.data_folder};
  }

  const gpu::Device& device;
  const WarpBenchOptions& options;
  Session session;
  Headset headset, no_lens;
  VolumePlacement placement;
  std::unique_ptr<SceneOnDevice> scene;
  PipelineStage no_warp;
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

namespace {

/// Eye frames as one warp needs them.
struct WarpFrames {
  WarpFrames(const WarpRig& rig, const PipelineStage& warp)
      : session(rig.session),
        renderer(rig.device, with_warp(warp), rig.headset, *rig.scene, rig.placement, rig.options.data_folder,
                 EyeRenderer::Counting::off, nullptr, EyeRenderer::SecondEye::as_session,
                 EyeRenderer::Layers::as_session),
        eyes(make_eye_pair(rig.device, session, rig.headset)) {}

  const Session& with_warp(const PipelineStage& warp) {
    session.pipeline.at("warp") = warp;
    return session;
  }

  double cast_ns(int repetitions) {
    std::vector<double> ns;
    for (int i = -1; i < repetitions; ++i) {
      const double one = static_cast<double>(renderer.render(Pose{}, eyes).device_time.count());
      if (i >= 0) ns.push_back(one);
    }
    return median(ns);
  }

  Session session;
  EyeRenderer renderer;
  EyePair eyes;
};

void measure_warp(const WarpRig& rig, const Variant& variant, WarpFrames& ideals, PanelDisplay& ideal_display,
                  WarpBenchResult& result) {
  const PipelineStage warp = stage_of(variant, rig.options.stages);
  WarpFrames frames(rig, warp);
  const double cast_ns = frames.cast_ns(3);
  for (const Motion& motion : motions()) {
    (void)ideals.renderer.render(motion.moved, ideals.eyes);
    ideal_display.show({ideals.eyes, Pose{}, Pose{}});
    const PanelPair ideal = ideal_display.read();
    // The cost without a lens, as the copy's; the picture with it.
    PanelDisplay bare = rig.display(rig.no_lens, warp), display = rig.display(rig.headset, warp);
    const double ns = time_of(bare, {frames.eyes, Pose{}, motion.moved}, rig.options.repetitions);
    display.show({frames.eyes, Pose{}, motion.moved});
    WarpBenchRow row{variant.label, motion.name, ns * 1e-6 / result.copy_ms, ns * 1e-6 / result.cast_ms,
                     cast_ns * 1e-6 / result.cast_ms};
    row.dssim = dssim(display.read(), ideal, rig.headset);
    row.texels = display.work().texels;
    const auto pixels = static_cast<double>(ideal_display.work().texels);
    row.filled_percent = 100.0 * static_cast<double>(display.counted().filled) / pixels;
    row.uncovered_percent = 100.0 * static_cast<double>(display.counted().uncovered) / pixels;
    result.rows.push_back(std::move(row));
  }
}

}  // namespace

WarpBenchResult bench_warp(const WarpBenchOptions& options) {
  WarpBenchResult result;
  getloadavg(&result.host_load, 1);
  const gpu::Device device(options.device);
  result.device = device.info().name;
  result.repetitions = options.repetitions;
  const WarpRig rig(device, options);
  WarpFrames plain(rig, rig.no_warp);
  result.cast_ms = plain.cast_ns(5) * 1e-6;
  PanelDisplay copy = rig.display(rig.no_lens, rig.no_warp);
  result.copy_ms = time_of(copy, {plain.eyes, Pose{}, Pose{}}, options.repetitions) * 1e-6;
  PanelDisplay ideal_display = rig.display(rig.headset, rig.no_warp);
  for (const Variant& variant : variants())
    measure_warp(rig, variant, plain, ideal_display, result);
  return result;
}

std::string to_text(const WarpBenchResult& result) {
  std::string text =
      fmt::format("warps on {}; {} repetitions, load {:.2f}; copy {:.3f} ms, cast {:.1f} ms\n\n",
                  result.device, result.repetitions, result.host_load, result.copy_ms, result.cast_ms);
  text += fmt::format("{:<18}{:<28}{:>9}{:>9}{:>12}{:>10}{:>10}{:>10}{:>12}\n", "head moved by", "warp",
                      "x copy", "x cast", "cast x cast", "texels", "DSSIM", "filled", "uncovered");
  for (const WarpBenchRow& row : result.rows)
    text += fmt::format("{:<18}{:<28}{:>9.3f}{:>9.4f}{:>12.3f}{:>10}{:>10.5f}{:>8.3f} %{:>10.3f} %\n",
                        row.motion, row.warp, row.over_copy, row.over_cast, row.cast_over_cast, row.texels,
                        row.dssim, row.filled_percent, row.uncovered_percent);
  text += "\ntargets: quad at most 1.2 x the copy, grid at most 3 x; volumetric at most 0.1 x the cast\n";
  return text;
}

std::string to_json(const WarpBenchResult& result) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const WarpBenchRow& row : result.rows)
    rows.push_back(nlohmann::ordered_json{{"warp", row.warp},
                                          {"motion", row.motion},
                                          {"over_copy", row.over_copy},
                                          {"over_cast", row.over_cast},
                                          {"cast_over_cast", row.cast_over_cast},
                                          {"texels", row.texels},
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
