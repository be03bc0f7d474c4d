#include "runtime/replay/single_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "runtime/replay/by_layers.hpp"
#include "runtime/replay/by_novel_view.hpp"

namespace brace {

std::optional<MabPlan> plan_mab(const Session& session, const Headset& headset) {
  const PipelineStage& rays = session.pipeline.at("rays");
  if (rays.stage.id() != "rays/mab") return {};
  return MabPlan(mab_settings(rays), headset.profile,
                 {.eye_px = {headset.eye.width_px, headset.eye.height_px},
                  .panel_px = {headset.panel.width_px, headset.panel.height_px},
                  .resolution_scale = session.device.resolution_scale});
}

void require_single_pass(const Session& session) {
  const std::string stereo = session.pipeline.at("stereo").stage.id();
  if (session.run.watchdog != WatchdogLevel::off) {
    throw input_error(
        "run.watchdog = '{}' does not look into {}; accepted with it: 'off', or stereo/two_pass",
        to_string(session.run.watchdog), stereo);
  }
  const std::string rays = session.pipeline.at("rays").stage.id();
  const bool has_atlas = rays == "rays/mab" && (is_by_layers(session) || session.full_rate);
  if (rays != "rays/full_rate" && !has_atlas) {
    throw input_error(
        "{} does not work with {}, whose rays it cannot place in a picture; accepted: rays/full_rate, "
        "rays/mab, or stereo/two_pass",
        stereo, rays);
  }
  const StageInfo& cast = session.pipeline.at("cast").stage;
  const auto& outputs = cast.outputs;
  if (std::find(outputs.begin(), outputs.end(), "segments") == outputs.end()) {
    throw input_error(
        "{} does not work with {}: that stage does not give its segments (outputs = [\"segments\"]); "
        "accepted: cast/dvr and cast/native, or stereo/two_pass",
        stereo, cast.id());
  }
}

EyeViews views_of(const Headset& headset, const Pose& world_from_head) {
  return {eye_view(headset, sim::Eye::left, world_from_head),
          eye_view(headset, sim::Eye::right, world_from_head)};
}

std::string SinglePass::fresh_rays_note(std::int64_t rays, std::int64_t frames) {
  return fmt::format(
      "{:.1f} rays per frame were cast for what a composed eye sees and no ray of the cast one knew",
      static_cast<double>(rays) / static_cast<double>(std::max<std::int64_t>(frames, 1)));
}

bool is_by_layers(const Session& session) {
  return session.pipeline.at("stereo").stage.id() == "stereo/layers";
}

bool is_by_novel_view(const Session& session) {
  return session.pipeline.at("stereo").stage.id() == "stereo/novel_view";
}

namespace {

/// An eye's picture in a level of rays/mab.
EyeView in_level(EyeView eye, const AtlasRect& level) {
  eye.width_px = level.width;
  eye.height_px = level.height;
  return eye;
}

/// What is composed, of the eyes that are.
std::vector<StereoPair> pairs_of(const EyeViews& eyes, bool from_middle, const Atlas* atlas) {
  const EyeView reference = from_middle ? middle_of(eyes) : eyes.left;
  std::vector<AtlasRect> levels;
  if (atlas != nullptr) levels = atlas->levels;
  if (levels.empty()) levels.push_back({0, 0, reference.width_px, reference.height_px});
  std::vector<StereoPair> pairs;
  for (const bool is_left : {true, false}) {
    if (is_left && !from_middle) continue;
    for (const AtlasRect& level : levels)
      pairs.push_back(stereo_pair(in_level(reference, level),
                                  in_level(is_left ? eyes.left : eyes.right, level), is_left));
  }
  return pairs;
}

}  // namespace

StereoPlan plan_single_pass(const gpu::Device& device, const Session& session, const Headset& headset,
                            const VolumeInfo& volume, const VolumePlacement& placement) {
  require_single_pass(session);
  EyeViews eyes = views_of(headset, Pose{});
  const std::optional<Rectification> planes = rectify(eyes);
  const std::optional<MabPlan> mab = plan_mab(session, headset);
  if (planes && mab) {
    throw input_error(
        "stereo/layers does not work with rays/mab on canted displays, whose pictures it rectifies: levels "
        "are laid out for the displays; accepted for {}: rays/full_rate, or with rays/mab stereo/novel_view",
        headset.profile.name);
  }
  if (planes) eyes = planes->apply(eyes);
  const StereoSettings settings = stereo_settings(session.pipeline.at("stereo"));
  const gpu::DeviceLimits& limits = device.limits();
  StereoPlan plan = plan_stereo(
      settings, pairs_of(eyes, settings.from_middle, mab ? &mab->atlas() : nullptr),
      bounding_radius_m(volume, placement),
      {std::min(limits.storage_buffer_bytes_max, limits.allocation_bytes_max), limits.memory_bytes},
      mab ? static_cast<int>(mab->atlas().levels.size()) : 0);
  plan.rectification = planes;
  if (planes) plan.summary += "; " + planes->summary();
  return plan;
}

SimDuration SinglePass::submit() {
  const SimDuration time(gpu::total_ns(gpu::submit_and_wait(commands_)));
  commands_.reset();
  return time;
}

CastArea rays_of(const CellCuts::Area& cell, const CastArea& all) {
  const auto edge = [](double share, int rays) { return static_cast<int>(std::floor(share * rays + 1e-9)); };
  const int x = edge(cell.left, all.width), y = edge(cell.top, all.height);
  return {all.x + x, all.y + y, edge(cell.right, all.width) - x, edge(cell.bottom, all.height) - y};
}

EyeCast SinglePass::eye_cast(const CastPipeline& pipeline, const CastPipeline::Resources& resources,
                             const EyeView& view) const {
  return {.device = device_,
          .pipeline = pipeline,
          .resources = resources,
          .view = view,
          .cast = native_cast_ ? &**native_cast_ : nullptr};
}

/// On the host, or only recorded.
void SinglePass::cast_opened(const EyeCast& eye, const CastArea& area, WorkCounts& counted) {
  if (eye.cast == nullptr) {
    step("cast", [&] { eye.pipeline.record_cast(commands_, eye.resources, area); });
    return;
  }
  submit_part();
  earlier_ += cast_on_host(eye, area, host_rays_, counted, commands_);
}

void SinglePass::cast_holes(const HoleRays& holes, const CastPipeline::Resources& resources,
                            const EyeView& view) {
  const CastArea area = holes.area(resources);
  CastPipeline::Resources of_holes = resources;
  // A ray per pixel, in buffers that may be those of a wider grid.
  if (!of_holes.grid) of_holes.grid = RayGrid{area.width, area.height};
  step("stereo", [&] { holes.record_opening(commands_, of_holes); });
  cast_opened(eye_cast(holes.pipeline(), of_holes, view), area, holes_work_);
  step("stereo", [&] { holes.record_closing(commands_, of_holes); });
}

WorkCounts SinglePass::counted_rays(const CastPipeline& pipeline) const {
  WorkCounts counted = pipeline.counted(device_);
  counted += rays_work_;
  return counted;
}

WorkCounts SinglePass::counted_holes(const HoleRays& holes) const {
  WorkCounts counted = holes.counted();
  counted += holes_work_;
  return counted;
}

void SinglePass::reset_holes(const HoleRays& holes) {
  holes.reset_counters();
  holes_work_ = {};
}

void SinglePass::cast_rays(const CastPipeline& pipeline, const CastPipeline::Resources& resources,
                           const EyeView& view, const CastArea& area, const Cells* cells) {
  pipeline.reset_counters(device_);
  rays_work_ = {};
  EyeCast eye = eye_cast(pipeline, resources, view);
  if (eye.cast != nullptr && pipeline.has_cast_kernel()) eye.segments = &replay_;
  commands_.reset();
  commands_.barrier();
  step("opening", [&] { pipeline.record_opening(commands_, resources, area); });
  if (cells == nullptr) return cast_opened(eye, area, rays_work_);
  const SimDuration opening = submit();
  std::vector<CellOutcome>& outcomes = cells->outcomes;
  outcomes.clear();
  for (int i = 0; i < cells->cuts.columns * cells->cuts.rows; ++i) {
    const CastArea cell = rays_of(cells->cuts.area(i), area);
    CellOutcome outcome;
    if (cell.width > 0 && cell.height > 0 && eye.cast != nullptr) {
      outcome.device_time = cast_on_host(eye, cell, host_rays_, outcome.work, commands_);
    } else if (cell.width > 0 && cell.height > 0) {
      pipeline.reset_counters(device_);
      step("cast", [&] { pipeline.record_cast(commands_, resources, cell); });
      outcome.device_time = submit();
      outcome.work = pipeline.counted(device_);
    }
    outcomes.push_back(outcome);
  }
  outcomes.front().device_time += opening;
}

JobOutcome SinglePass::finish(const std::function<WorkCounts()>& work, const Cells* cells) {
  JobOutcome outcome;
  outcome.device_time = submit() + std::exchange(earlier_, SimDuration(0));
  outcome.work = work();
  if (cells == nullptr) return outcome;
  std::vector<CellOutcome>& outcomes = cells->outcomes;
  const CellOutcome last{outcome.work, outcome.device_time};
  for (const CellOutcome& cell : outcomes) {
    outcome.work += cell.work;
    outcome.device_time += cell.device_time;
  }
  outcomes.resize(2 * outcomes.size());
  outcomes.back() = last;
  outcome.cells = outcomes;
  return outcome;
}

std::unique_ptr<SinglePass> make_single_pass(const SinglePass::Inputs& in,
                                             const std::function<CastKernels(bool)>& cast_kernels) {
  if (is_by_novel_view(in.session))
    return std::make_unique<ByNovelView>(in, cast_kernels(true), cast_kernels(false));
  const StereoPlan plan =
      plan_single_pass(in.device, in.session, in.headset, in.scene.volume.info(), in.placement);
  CastKernels kernels = cast_kernels(!plan.layers_left_out);
  // Segments by level and texel, where rays are those of an atlas.
  if (plan.levels > 0) kernels.cast.defines.emplace_back("BRACE_STEREO_BY_TEXEL", "1");
  return std::make_unique<ByLayers>(in, plan, kernels, cast_kernels(false));
}

}  // namespace brace
