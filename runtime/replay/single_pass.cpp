#include "runtime/replay/single_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

void require_stages(const Session& session) {
  const std::string stereo = session.pipeline.at("stereo").stage.id();
  if (session.run.watchdog != WatchdogLevel::off) {
    throw input_error(
        "run.watchdog = '{}' does not look into {}; accepted with it: 'off', or stereo/two_pass",
        to_string(session.run.watchdog), stereo);
  }
  const StageInfo& rays = session.pipeline.at("rays").stage;
  if (rays.id() != "rays/full_rate") {
    throw input_error(
        "{} does not work with {}: its layers need a ray per pixel; accepted: rays/full_rate, or "
        "stereo/two_pass",
        stereo, rays.id());
  }
  const StageInfo& cast = session.pipeline.at("cast").stage;
  const auto& outputs = cast.outputs;
  if (std::find(outputs.begin(), outputs.end(), "segments") == outputs.end()) {
    throw input_error(
        "{} does not work with {}: that stage does not give its segments (outputs = [\"segments\"]); "
        "accepted: "
        "cast/dvr, or stereo/two_pass",
        stereo, cast.id());
  }
}

EyeViews views_of(const Headset& headset, const Pose& world_from_head) {
  return {eye_view(headset, sim::Eye::left, world_from_head),
          eye_view(headset, sim::Eye::right, world_from_head)};
}

std::string fresh_rays_note(std::int64_t rays, std::int64_t frames) {
  return fmt::format(
      "{:.1f} pixels per frame of the right eye got a ray of their own: no left ray knew what is there",
      static_cast<double>(rays) / static_cast<double>(std::max<std::int64_t>(frames, 1)));
}

NovelView::Folders hole_folders(const SinglePass::Inputs& in) {
  return {in.data_folder / "glsl", in.data_folder / "kernels" / "warp_layers"};
}

}  // namespace

bool is_by_layers(const Session& session) {
  return session.pipeline.at("stereo").stage.id() == "stereo/layers";
}

bool is_by_novel_view(const Session& session) {
  return session.pipeline.at("stereo").stage.id() == "stereo/novel_view";
}

StereoPlan plan_single_pass(const gpu::Device& device, const Session& session, const Headset& headset,
                            const VolumeInfo& volume, const VolumePlacement& placement) {
  require_stages(session);
  const EyeViews eyes = views_of(headset, Pose{});
  const gpu::DeviceLimits& limits = device.limits();
  return plan_stereo(
      stereo_settings(session.pipeline.at("stereo")), stereo_geometry(eyes.left, eyes.right),
      headset.eye.width_px, headset.eye.height_px, bounding_radius_m(volume, placement),
      {std::min(limits.storage_buffer_bytes_max, limits.allocation_bytes_max), limits.memory_bytes});
}

ByLayers::ByLayers(const Inputs& in, const StereoPlan& plan, const CastKernels& kernels,
                   const CastKernels& plain)
    : device_(in.device),
      headset_(in.headset),
      scene_(in.scene),
      placement_(in.placement),
      pipeline_(in.device, kernels),
      layers_(in.device, in.session.pipeline.at("stereo"), plan, in.headset.eye.width_px,
              in.headset.eye.height_px, {in.data_folder / "glsl", in.data_folder / "kernels" / "stereo"}),
      commands_(in.device, "single-pass stereo") {
  if (plan.settings.fresh_rays && !plan.layers_left_out)
    holes_.emplace(in.device, plain, in.headset.eye.width_px, in.headset.eye.height_px, hole_folders(in));
}

std::optional<JobOutcome> ByLayers::render(const Pose& world_from_head, const EyePair& into) {
  const EyeViews eyes = views_of(headset_, world_from_head);
  ++frames_;
  if (!layers_.begin_frame(eyes, scene_.volume.info(), placement_)) {
    ++cast_twice_;
    return {};
  }
  const EyeTarget& left = into[0];
  const EyeTarget& right = into[1];
  CastPipeline::set_eye(device_, left, eyes.left, placement_, scene_.volume, scene_.transfer, layers_.grid());
  CastPipeline::set_eye(device_, right, eyes.right, placement_, scene_.volume, scene_.transfer,
                        holes_ ? std::optional(holes_->grid()) : std::nullopt);
  const auto skip = scene_.skip_bindings();
  bindings_.assign(skip.begin(), skip.end());
  if (!layers_.plan().layers_left_out) {
    bindings_.insert(bindings_.end(), layers_.bindings().begin(), layers_.bindings().end());
  }
  const CastPipeline::Resources resources{scene_.volume, scene_.transfer, layers_.rays(), left, bindings_};
  pipeline_.reset_counters(device_);
  layers_.reset_counters();
  if (holes_) holes_->reset_counters();
  commands_.reset();
  const auto step = [&](const char* name, const auto& record) {
    commands_.begin_timing(name);
    record();
    commands_.barrier();
    commands_.end_timing();
  };
  commands_.barrier();
  step("opening", [&] { pipeline_.record_opening(commands_, resources, layers_.ray_area()); });
  step("cast", [&] { pipeline_.record_cast(commands_, resources, layers_.ray_area()); });
  step("closing", [&] {
    pipeline_.record_closing(commands_, resources, {0, 0, left.width_px, left.height_px});
  });
  step("stereo", [&] {
    layers_.record_second_eye(commands_, left, right, holes_ ? &holes_->holes() : nullptr);
    if (!holes_) return;
    commands_.barrier();
    holes_->record(
        commands_,
        {scene_.volume, scene_.transfer, layers_.rays(), right, scene_.skip_bindings(), {}, holes_->grid()});
  });
  JobOutcome outcome;
  for (const gpu::Timing& timing : gpu::submit_and_wait(commands_))
    outcome.device_time += SimDuration(timing.device_ns);
  outcome.work = pipeline_.counted(device_);
  const StereoLayers::Counts counts = layers_.counted();
  // In the texels of cost models, 8 bytes read and 8 written. Neighbours find the range of a ray, 8 bytes, in
  // the cache (assumed): it is written once and read once.
  const auto texel_bytes = static_cast<std::uint64_t>(layers_.plan().settings.bytes_per_texel);
  outcome.work.texels = (std::uint64_t{counts.written} + counts.read) * texel_bytes / 16 + outcome.work.rays;
  if (holes_) {
    const WorkCounts fresh = holes_->counted();
    outcome.work += fresh;
    fresh_rays_ += static_cast<std::int64_t>(fresh.rays);
  }
  return outcome;
}

std::string ByLayers::note() const {
  const std::string fresh = holes_ ? fresh_rays_note(fresh_rays_, frames_ - cast_twice_) : "";
  if (cast_twice_ == 0) return fresh;
  return fresh + (fresh.empty() ? "" : "; ") +
         fmt::format(
             "{} of {} eye frames were ray cast twice: the volume was nearer than the layers allow ({}); a "
             "smaller "
             "near_m, or more layers, takes it",
             cast_twice_, frames_, layers_.plan().summary);
}

namespace {

/// The tangents of the left eye between which the right eye sees content at depths from near_m on. Canted
/// displays are eyes like others here.
EyeView widened(const EyeViews& eyes, double near_m) {
  constexpr double far_m = 1e3;
  EyeView wide = eyes.left;
  const EyeView& right = eyes.right;
  const Pose left_from_right = compose(inverse(eyes.left.world_from_eye), right.world_from_eye);
  const std::array xs = {right.tan_left, 0.5 * (right.tan_left + right.tan_right), right.tan_right};
  const std::array ys = {right.tan_bottom, 0.5 * (right.tan_bottom + right.tan_top), right.tan_top};
  for (const double x : xs)
    for (const double y : ys)
      for (const double depth_m : {near_m, far_m}) {
        const glm::dvec3 p =
            left_from_right.orientation * (depth_m * glm::dvec3(x, y, -1.0)) + left_from_right.position;
        if (p.z >= -0.1 * depth_m) continue;  // so far beside that no plane shows it
        wide.tan_left = std::min(wide.tan_left, p.x / -p.z);
        wide.tan_right = std::max(wide.tan_right, p.x / -p.z);
        wide.tan_bottom = std::min(wide.tan_bottom, p.y / -p.z);
        wide.tan_top = std::max(wide.tan_top, p.y / -p.z);
      }
  return wide;
}

/// The left eye's rays with those beside its picture that the right eye sees content of.
RayGrid grid_with_margins(const Headset& headset, double near_m) {
  const EyeViews eyes = views_of(headset, Pose{});
  const EyeView wide = widened(eyes, near_m);
  const double across = (eyes.left.tan_right - eyes.left.tan_left) / headset.eye.width_px;
  const double down = (eyes.left.tan_top - eyes.left.tan_bottom) / headset.eye.height_px;
  const auto pixels = [](double tangents, double per_px) {
    return static_cast<int>(std::ceil(tangents / per_px - 1e-9));
  };
  const int left = pixels(eyes.left.tan_left - wide.tan_left, across);
  const int right = pixels(wide.tan_right - eyes.left.tan_right, across);
  const int top = pixels(wide.tan_top - eyes.left.tan_top, down);
  const int bottom = pixels(eyes.left.tan_bottom - wide.tan_bottom, down);
  return {left + headset.eye.width_px + right, top + headset.eye.height_px + bottom, left, top};
}

gpu::Buffer layer_buffer(const gpu::Device& device, const RayGrid& grid, const PipelineStage& stereo) {
  const auto layers = static_cast<std::uint64_t>(stereo.value("layers"));
  const std::uint64_t rays = static_cast<std::uint64_t>(grid.across) * static_cast<std::uint64_t>(grid.down);
  const std::uint64_t bytes = rays * layers * 16, bytes_max = device.limits().storage_buffer_bytes_max;
  if (bytes > bytes_max) {
    throw input_error(
        "{}: {} layers of {} x {} rays need {} bytes, but {} binds at most {}; accepted: layers up to {}, or "
        "a smaller "
        "device.resolution_scale",
        stereo.stage.id(), layers, grid.across, grid.down, bytes, device.info().name, bytes_max,
        bytes_max / (rays * 16));
  }
  return {device, "novel view layers", bytes, gpu::Memory::device};
}

const Session& checked(const Session& session) {
  require_stages(session);
  return session;
}

}  // namespace

ByNovelView::ByNovelView(const Inputs& in, const CastKernels& kernels, const CastKernels& plain)
    : device_(in.device),
      headset_(in.headset),
      scene_(in.scene),
      placement_(in.placement),
      grid_(grid_with_margins(in.headset, checked(in.session).pipeline.at("stereo").value("near_m"))),
      pipeline_(in.device, kernels),
      rays_(in.device, grid_.across, grid_.down),
      layers_(layer_buffer(in.device, grid_, in.session.pipeline.at("stereo"))),
      view_(in.device, in.session.pipeline.at("stereo"), hole_folders(in), false, true),
      holes_(in.device, plain, in.headset.eye.width_px, in.headset.eye.height_px, hole_folders(in)),
      box_{in.placement.world_from_volume,
           box_size_with_longest_edge(in.scene.volume.info(), in.placement.size_m)},
      commands_(in.device, "stereo by novel view") {}

void ByNovelView::record_left(const EyeTarget& left) {
  const CastPipeline::Resources resources{scene_.volume, scene_.transfer, rays_, left, bindings_};
  const CastArea all{0, 0, grid_.across, grid_.down};
  commands_.barrier();
  commands_.begin_timing("cast");
  pipeline_.record_opening(commands_, resources, all);
  commands_.barrier();
  pipeline_.record_cast(commands_, resources, all);
  commands_.barrier();
  pipeline_.record_closing(commands_, resources, {0, 0, left.width_px, left.height_px});
  commands_.barrier();
  commands_.end_timing();
}

std::optional<JobOutcome> ByNovelView::render(const Pose& world_from_head, const EyePair& into) {
  const EyeViews eyes = views_of(headset_, world_from_head);
  ++frames_;
  const EyeTarget &left = into[0], &right = into[1];
  CastPipeline::set_eye(device_, left, eyes.left, placement_, scene_.volume, scene_.transfer, grid_);
  CastPipeline::set_eye(device_, right, eyes.right, placement_, scene_.volume, scene_.transfer,
                        holes_.grid());
  const auto skip = scene_.skip_bindings();
  bindings_.assign(skip.begin(), skip.end());
  bindings_.push_back(layers_binding(layers_));
  pipeline_.reset_counters(device_);
  holes_.reset_counters();
  commands_.reset();
  record_left(left);
  commands_.begin_timing("stereo");
  view_.record(commands_, {layers_, eyes.left, grid_}, eyes.right, right, box_, &holes_.holes());
  holes_.record(commands_, {scene_.volume, scene_.transfer, rays_, right, bindings_, {}, holes_.grid()});
  commands_.end_timing();
  JobOutcome outcome;
  for (const gpu::Timing& timing : gpu::submit_and_wait(commands_))
    outcome.device_time += SimDuration(timing.device_ns);
  const WorkCounts fresh = holes_.counted();
  outcome.work = pipeline_.counted(device_);
  outcome.work += fresh;
  outcome.work.texels = view_.counted().segments;
  fresh_rays_ += static_cast<std::int64_t>(fresh.rays);
  view_.reset_counters();
  return outcome;
}

std::string ByNovelView::note() const {
  return fresh_rays_note(fresh_rays_, frames_);
}

std::unique_ptr<SinglePass> make_single_pass(const SinglePass::Inputs& in,
                                             const std::function<CastKernels(bool)>& cast_kernels) {
  if (is_by_novel_view(in.session))
    return std::make_unique<ByNovelView>(in, cast_kernels(true), cast_kernels(false));
  const StereoPlan plan =
      plan_single_pass(in.device, in.session, in.headset, in.scene.volume.info(), in.placement);
  return std::make_unique<ByLayers>(in, plan, cast_kernels(!plan.layers_left_out), cast_kernels(false));
}

}  // namespace brace
