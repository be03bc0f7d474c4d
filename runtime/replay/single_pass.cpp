#include "runtime/replay/single_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

bool is_by_atlas(const Session& session) {
  return session.pipeline.at("rays").stage.id() == "rays/mab";
}

void require_stages(const Session& session) {
  const std::string stereo = session.pipeline.at("stereo").stage.id();
  if (session.run.watchdog != WatchdogLevel::off) {
    throw input_error(
        "run.watchdog = '{}' does not look into {}; accepted with it: 'off', or stereo/two_pass",
        to_string(session.run.watchdog), stereo);
  }
  const StageInfo& rays = session.pipeline.at("rays").stage;
  const bool by_atlas = is_by_novel_view(session) && is_by_atlas(session) && session.full_rate;
  if (rays.id() != "rays/full_rate" && !by_atlas) {
    throw input_error(
        "{} does not work with {}: its layers need a ray per pixel, which it writes to the right eye's "
        "pixels "
        "row by row; accepted: rays/full_rate, or stereo/two_pass{}",
        stereo, rays.id(),
        is_by_novel_view(session) ? ", or rays/mab" : ", or with rays/mab stereo/novel_view");
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
  EyeViews eyes = views_of(headset, Pose{});
  const std::optional<Rectification> planes = rectify(eyes);
  if (planes) eyes = planes->apply(eyes);
  const gpu::DeviceLimits& limits = device.limits();
  StereoPlan plan = plan_stereo(
      stereo_settings(session.pipeline.at("stereo")), stereo_geometry(eyes.left, eyes.right),
      eyes.left.width_px, eyes.left.height_px, bounding_radius_m(volume, placement),
      {std::min(limits.storage_buffer_bytes_max, limits.allocation_bytes_max), limits.memory_bytes});
  plan.rectification = planes;
  if (planes) plan.summary += "; " + planes->summary();
  return plan;
}

SimDuration SinglePass::submit() {
  SimDuration time{0};
  for (const gpu::Timing& timing : gpu::submit_and_wait(commands_))
    time += SimDuration(timing.device_ns);
  commands_.reset();
  return time;
}

CastArea rays_of(const CellCuts::Area& cell, const CastArea& all) {
  const auto edge = [](double share, int rays) { return static_cast<int>(std::floor(share * rays + 1e-9)); };
  const int x = edge(cell.left, all.width), y = edge(cell.top, all.height);
  return {all.x + x, all.y + y, edge(cell.right, all.width) - x, edge(cell.bottom, all.height) - y};
}

void SinglePass::cast_rays(const CastPipeline& pipeline, const CastPipeline::Resources& resources,
                           const CastArea& area, const Cells* cells) {
  pipeline.reset_counters(device_);
  commands_.reset();
  commands_.barrier();
  step("opening", [&] { pipeline.record_opening(commands_, resources, area); });
  if (cells == nullptr) {
    step("cast", [&] { pipeline.record_cast(commands_, resources, area); });
    return;
  }
  const SimDuration opening = submit();
  std::vector<CellOutcome>& outcomes = cells->outcomes;
  outcomes.clear();
  for (int i = 0; i < cells->cuts.columns * cells->cuts.rows; ++i) {
    const CastArea cell = rays_of(cells->cuts.area(i), area);
    CellOutcome outcome;
    if (cell.width > 0 && cell.height > 0) {
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
  outcome.device_time = submit();
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

ByLayers::Rectified::Rectified(const Inputs& in, const Rectification& onto)
    : planes(onto),
      pictures{EyeTarget(in.device, planes.width_px, planes.height_px),
               EyeTarget(in.device, planes.width_px, planes.height_px)},
      resamplers([&] {
        const EyeViews to = views_of(in.headset, Pose{}), from = planes.apply(to);
        const PlaneResampler::Folders folders{in.data_folder / "glsl", in.data_folder / "kernels" / "stereo"};
        return std::array{PlaneResampler(in.device, from.left, to.left, folders),
                          PlaneResampler(in.device, from.right, to.right, folders)};
      }()) {}

ByLayers::ByLayers(const Inputs& in, const StereoPlan& plan, const CastKernels& kernels,
                   const CastKernels& plain)
    : SinglePass(in.device, "single-pass stereo"),
      headset_(in.headset),
      scene_(in.scene),
      placement_(in.placement),
      pipeline_(in.device, kernels),
      layers_(in.device, in.session.pipeline.at("stereo"), plan, plan.width_px, plan.height_px,
              {in.data_folder / "glsl", in.data_folder / "kernels" / "stereo"}) {
  if (plan.rectification) rectified_.emplace(in, *plan.rectification);
  if (plan.settings.fresh_rays && !plan.layers_left_out)
    holes_.emplace(in.device, plain, plan.width_px, plan.height_px, hole_folders(in));
}

std::optional<JobOutcome> ByLayers::render(const Pose& world_from_head, const EyePair& into,
                                           double /*quality*/, const Cells* cells) {
  EyeViews eyes = views_of(headset_, world_from_head);
  if (rectified_) eyes = rectified_->planes.apply(eyes);
  ++frames_;
  if (!layers_.begin_frame(eyes, scene_.volume.info(), placement_)) {
    ++cast_twice_;
    return {};
  }
  const EyePair& pictures = rectified_ ? rectified_->pictures : into;
  const EyeTarget &left = pictures[0], &right = pictures[1];
  CastPipeline::set_eye(device_, left, eyes.left, placement_, scene_.volume, scene_.transfer, layers_.grid());
  CastPipeline::set_eye(device_, right, eyes.right, placement_, scene_.volume, scene_.transfer,
                        holes_ ? std::optional(holes_->grid()) : std::nullopt);
  const auto skip = scene_.skip_bindings();
  bindings_.assign(skip.begin(), skip.end());
  if (!layers_.plan().layers_left_out)
    bindings_.insert(bindings_.end(), layers_.bindings().begin(), layers_.bindings().end());
  const CastPipeline::Resources resources{scene_.volume, scene_.transfer, layers_.rays(), left, bindings_};
  layers_.reset_counters();
  if (holes_) holes_->reset_counters();
  cast_rays(pipeline_, resources, layers_.ray_area(), cells);
  step("closing", [&] {
    pipeline_.record_closing(commands_, resources, {0, 0, left.width_px, left.height_px});
  });
  step("stereo", [&] { record_second_eye(left, right); });
  if (rectified_) {
    step("stereo", [&] {
      for (std::size_t eye = 0; eye < 2; ++eye)
        rectified_->resamplers[eye].record(commands_, pictures[eye], into[eye]);
    });
  }
  return finish([&] { return work_of_frame(cells); }, cells);
}

void ByLayers::record_second_eye(const EyeTarget& left, const EyeTarget& right) {
  layers_.record_second_eye(commands_, left, right, holes_ ? &holes_->holes() : nullptr);
  if (!holes_) return;
  commands_.barrier();
  holes_->record(
      commands_,
      {scene_.volume, scene_.transfer, layers_.rays(), right, scene_.skip_bindings(), {}, holes_->grid()});
}

WorkCounts ByLayers::work_of_frame(const Cells* cells) {
  WorkCounts work;
  if (cells == nullptr) work = pipeline_.counted(device_);
  const StereoLayers::Counts counts = layers_.counted();
  // In the texels of cost models, 8 bytes read and 8 written. Neighbours find the range of a ray, 8 bytes, in
  // the cache (assumed): it is written once and read once.
  const auto texel_bytes = static_cast<std::uint64_t>(layers_.plan().settings.bytes_per_texel);
  const auto rays = static_cast<std::uint64_t>(layers_.ray_area().width * layers_.ray_area().height);
  work.texels = (std::uint64_t{counts.written} + counts.read) * texel_bytes / 16 + rays;
  if (rectified_) {  // each pixel of the displays read and written once
    const PictureSize& eye = headset_.eye;
    work.texels += 2u * static_cast<std::uint64_t>(eye.width_px) * static_cast<std::uint64_t>(eye.height_px);
  }
  if (holes_) {
    const WorkCounts fresh = holes_->counted();
    work += fresh;
    fresh_rays_ += static_cast<std::int64_t>(fresh.rays);
  }
  return work;
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

/// What the rays are cast from: the left eye, or a place between both that looks as the left does.
EyeView reference_of(const EyeViews& eyes, bool middle) {
  EyeView reference = eyes.left;
  if (!middle) return reference;
  const Pose &left = eyes.left.world_from_eye, &right = eyes.right.world_from_eye;
  reference.world_from_eye.position = 0.5 * (left.position + right.position);
  reference.world_from_eye.orientation = glm::slerp(left.orientation, right.orientation, 0.5);
  return reference;
}

/// `wide`, with the tangents of `reference` between which an eye sees content at depths from near_m on.
/// Canted displays are eyes like others here.
EyeView widened(EyeView wide, const EyeView& reference, const EyeView& eye, double near_m) {
  constexpr double far_m = 1e3;
  const Pose reference_from_eye = compose(inverse(reference.world_from_eye), eye.world_from_eye);
  const std::array xs = {eye.tan_left, 0.5 * (eye.tan_left + eye.tan_right), eye.tan_right};
  const std::array ys = {eye.tan_bottom, 0.5 * (eye.tan_bottom + eye.tan_top), eye.tan_top};
  for (const double x : xs)
    for (const double y : ys)
      for (const double depth_m : {near_m, far_m}) {
        const glm::dvec3 p =
            reference_from_eye.orientation * (depth_m * glm::dvec3(x, y, -1.0)) + reference_from_eye.position;
        if (p.z >= -0.1 * depth_m) continue;  // so far beside that no plane shows it
        wide.tan_left = std::min(wide.tan_left, p.x / -p.z);
        wide.tan_right = std::max(wide.tan_right, p.x / -p.z);
        wide.tan_bottom = std::min(wide.tan_bottom, p.y / -p.z);
        wide.tan_top = std::max(wide.tan_top, p.y / -p.z);
      }
  return wide;
}

/// The reference's rays with those beside its picture that an eye sees content of.
RayGrid grid_with_margins(const Headset& headset, double near_m, bool middle) {
  const EyeViews eyes = views_of(headset, Pose{});
  const EyeView reference = reference_of(eyes, middle);
  EyeView wide = widened(reference, reference, eyes.right, near_m);
  if (middle) wide = widened(wide, reference, eyes.left, near_m);
  const double across = (reference.tan_right - reference.tan_left) / headset.eye.width_px;
  const double down = (reference.tan_top - reference.tan_bottom) / headset.eye.height_px;
  const auto pixels = [](double tangents, double per_px) {
    return static_cast<int>(std::ceil(tangents / per_px - 1e-9));
  };
  const int left = pixels(reference.tan_left - wide.tan_left, across);
  const int right = pixels(wide.tan_right - reference.tan_right, across);
  const int top = pixels(wide.tan_top - reference.tan_top, down);
  const int bottom = pixels(reference.tan_bottom - wide.tan_bottom, down);
  return {left + headset.eye.width_px + right, top + headset.eye.height_px + bottom, left, top};
}

constexpr std::uint64_t kLayerBytes = 16;  // of a ray

std::uint64_t rays_of(const RayGrid& grid) {
  return static_cast<std::uint64_t>(grid.across) * static_cast<std::uint64_t>(grid.down);
}

gpu::Buffer layer_buffer(const gpu::Device& device, const RayGrid& grid, const PipelineStage& stereo) {
  const auto layers = static_cast<std::uint64_t>(stereo.value("layers"));
  const std::uint64_t bytes = rays_of(grid) * layers * kLayerBytes;
  const std::uint64_t bytes_max = device.limits().storage_buffer_bytes_max;
  if (bytes > bytes_max) {
    throw input_error(
        "{}: {} layers of {} x {} rays need {} bytes, but {} binds at most {}; accepted: layers up to {}, or "
        "a smaller "
        "device.resolution_scale",
        stereo.stage.id(), layers, grid.across, grid.down, bytes, device.info().name, bytes_max,
        bytes_max / (rays_of(grid) * kLayerBytes));
  }
  return {device, "novel view layers", bytes, gpu::Memory::device};
}

const Session& checked(const Session& session) {
  require_stages(session);
  return session;
}

/// The eye that is cast with the rays beside its picture as an eye of its own, a pixel per ray.
EyeView wide_view(const EyeView& eye, const RayGrid& grid) {
  const double dx = (eye.tan_right - eye.tan_left) / eye.width_px;
  const double dy = (eye.tan_top - eye.tan_bottom) / eye.height_px;
  EyeView wide = eye;
  wide.tan_left = eye.tan_left - grid.left * dx;
  wide.tan_right = wide.tan_left + grid.across * dx;
  wide.tan_top = eye.tan_top + grid.top * dy;
  wide.tan_bottom = wide.tan_top - grid.down * dy;
  wide.width_px = grid.across;
  wide.height_px = grid.down;
  return wide;
}

/// An atlas over the wide picture. The plan's second eye is the same one: it casts nothing.
std::unique_ptr<MabBraces> wide_mab(const SinglePass::Inputs& in, const RayGrid& grid, bool middle) {
  if (!is_by_atlas(in.session)) return nullptr;
  const Headset& headset = in.headset;
  const EyeView wide = wide_view(reference_of(views_of(headset, Pose{}), middle), grid);
  sim::DeviceProfile profile = headset.profile;
  profile.eyes[0].fov = {wide.tan_left, wide.tan_right, wide.tan_bottom, wide.tan_top};
  profile.eyes[1] = profile.eyes[0];
  const MabPlan::Sizes sizes{.eye_px = {grid.across, grid.down},
                             .panel_px = {headset.panel.width_px, headset.panel.height_px},
                             .resolution_scale = in.session.device.resolution_scale};
  return std::make_unique<MabBraces>(in.device,
                                     MabPlan(mab_settings(in.session.pipeline.at("rays")), profile, sizes));
}

EyeTarget wide_target(const SinglePass::Inputs& in, const RayGrid& grid, const MabBraces* mab) {
  if (mab == nullptr) return {};
  const int layers = static_cast<int>(in.session.pipeline.at("stereo").value("layers"));
  return {in.device, grid.across, grid.down, {layers, mab->plan().capacity()}};
}

RayBuffers ray_buffers(const SinglePass::Inputs& in, const RayGrid& grid) {
  const PictureSize& eye = in.headset.eye;
  return is_by_atlas(in.session) ? RayBuffers(in.device, eye.width_px, eye.height_px)
                                 : RayBuffers(in.device, grid.across, grid.down);
}

}  // namespace

NovelViewMemory novel_view_memory(const Session& session, const Headset& headset) {
  const PipelineStage& stereo = session.pipeline.at("stereo");
  const RayGrid grid = grid_with_margins(headset, stereo.value("near_m"), stereo.value("reference") == 1.0);
  const auto layers = static_cast<std::uint64_t>(stereo.value("layers"));
  NovelViewMemory memory{rays_of(grid) * layers * kLayerBytes, ""};
  memory.summary = fmt::format("{} layers of {} x {} rays, {:.2f} MiB", layers, grid.across, grid.down,
                               static_cast<double>(memory.bytes) / (1024.0 * 1024.0));
  return memory;
}

ByNovelView::ByNovelView(const Inputs& in, const CastKernels& kernels, const CastKernels& plain)
    : SinglePass(in.device, "stereo by novel view"),
      headset_(in.headset),
      scene_(in.scene),
      placement_(in.placement),
      middle_(checked(in.session).pipeline.at("stereo").value("reference") == 1.0),
      grid_(grid_with_margins(in.headset, in.session.pipeline.at("stereo").value("near_m"), middle_)),
      mab_(wide_mab(in, grid_, middle_)),
      wide_(wide_target(in, grid_, mab_.get())),
      pipeline_(in.device, kernels),
      rays_(ray_buffers(in, grid_)),
      layers_(mab_ ? gpu::Buffer() : layer_buffer(in.device, grid_, in.session.pipeline.at("stereo"))),
      view_(in.device, in.session.pipeline.at("stereo"), hole_folders(in), mab_ != nullptr, true),
      holes_(in.device, plain, in.headset.eye.width_px, in.headset.eye.height_px, hole_folders(in)),
      box_{in.placement.world_from_volume,
           box_size_with_longest_edge(in.scene.volume.info(), in.placement.size_m)} {
  if (middle_) reference_.emplace(in.device, in.headset.eye.width_px, in.headset.eye.height_px);
}

void ByNovelView::bind() {
  const auto skip = scene_.skip_bindings();
  bindings_.assign(skip.begin(), skip.end());
  bindings_.push_back(layers_binding(mab_ ? wide_.layers : layers_));
  if (!mab_) return;
  bindings_.push_back(layer_rays_binding(wide_));
  const auto of_atlas = mab_->bindings(sim::Eye::left);
  bindings_.insert(bindings_.end(), of_atlas.begin(), of_atlas.end());
}

CastPipeline::Resources ByNovelView::resources_of(const EyeTarget& target) const {
  return {scene_.volume, scene_.transfer, mab_ ? mab_->rays() : rays_, target, bindings_, {}, ray_grid()};
}

LayerSource ByNovelView::layer_source_of(const EyeView& reference) const {
  if (mab_) return layer_source(wide_, wide_view(reference, grid_));
  return {layers_, reference, grid_};
}

/// The cast eye's own picture out of the wide one.
void ByNovelView::cut_out(const EyeTarget& into) {
  const auto bytes = [](int pixels) { return static_cast<std::uint64_t>(pixels) * 4; };
  for (int row = 0; row < into.height_px; ++row) {
    const std::uint64_t from = bytes((row + grid_.top) * grid_.across + grid_.left);
    commands_.copy(wide_.image, into.image, bytes(into.width_px), from, bytes(row * into.width_px));
    commands_.copy(wide_.depth, into.depth, bytes(into.width_px), from, bytes(row * into.width_px));
  }
}

void ByNovelView::record_view(const EyeView& reference, const EyeView& eye, const EyeTarget& into) {
  CastPipeline::set_eye(device_, into, eye, placement_, scene_.volume, scene_.transfer, holes_.grid());
  commands_.begin_timing("stereo");
  view_.record(commands_, layer_source_of(reference), eye, into, box_, &holes_.holes());
  holes_.record(commands_, {scene_.volume, scene_.transfer, rays_, into, bindings_, {}, holes_.grid()});
  commands_.end_timing();
}

std::optional<JobOutcome> ByNovelView::render(const Pose& world_from_head, const EyePair& into,
                                              double quality, const Cells* cells) {
  const EyeViews eyes = views_of(headset_, world_from_head);
  const EyeView reference = reference_of(eyes, middle_);
  ++frames_;
  if (mab_) mab_->set_quality(quality);
  const EyeTarget& cast_into = mab_ ? wide_ : middle_ ? *reference_ : into[0];
  CastPipeline::set_eye(device_, cast_into, mab_ ? wide_view(reference, grid_) : reference, placement_,
                        scene_.volume, scene_.transfer, ray_grid());
  bind();
  holes_.reset_counters();
  const CastPipeline::Resources resources = resources_of(cast_into);
  cast_rays(pipeline_, resources, {0, 0, resources.rays_across(), resources.rays_down()}, cells);
  SimDuration first_view{0};
  if (!middle_ || mab_) {  // with an atlas it says whose layers a pixel has, too
    step("closing", [&] {
      pipeline_.record_closing(commands_, resources, {0, 0, cast_into.width_px, cast_into.height_px});
    });
  }
  if (mab_ && !middle_) step("closing", [&] { cut_out(into[0]); });
  if (middle_) {
    record_view(reference, eyes.left, into[0]);
    first_view = submit();  // the next view has the same parameters
  }
  record_view(reference, eyes.right, into[1]);
  JobOutcome outcome = finish([&] { return work_of_frame(cells); }, cells);
  outcome.device_time += first_view;
  if (cells != nullptr) cells->outcomes.back().device_time += first_view;
  return outcome;
}

WorkCounts ByNovelView::work_of_frame(const Cells* cells) {
  const WorkCounts fresh = holes_.counted();
  WorkCounts work = fresh;
  if (cells == nullptr) work += pipeline_.counted(device_);
  work.texels = view_.counted().segments;
  fresh_rays_ += static_cast<std::int64_t>(fresh.rays);
  view_.reset_counters();
  return work;
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
