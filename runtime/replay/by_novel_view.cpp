#include "runtime/replay/by_novel_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

/// What the rays are cast from.
EyeView reference_of(const EyeViews& eyes, bool middle) {
  return middle ? middle_of(eyes) : eyes.left;
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

bool is_by_atlas(const Session& session) {
  return session.pipeline.at("rays").stage.id() == "rays/mab";
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
  require_single_pass(session);
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
    : SinglePass(in, "stereo by novel view"),
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
  return {scene_.volume,     scene_.transfer, mab_ ? mab_->rays() : rays_, target, bindings_,
          scene_.skip_map(), ray_grid()};
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
  step("stereo",
       [&] { view_.record(commands_, layer_source_of(reference), eye, into, box_, &holes_.holes()); });
  cast_holes(holes_,
             {scene_.volume, scene_.transfer, rays_, into, bindings_, scene_.skip_map(), holes_.grid()}, eye);
}

std::optional<JobOutcome> ByNovelView::render(const Pose& world_from_head, const EyePair& into,
                                              double quality, const Cells* cells) {
  const EyeViews eyes = views_of(headset_, world_from_head);
  const EyeView reference = reference_of(eyes, middle_);
  ++frames_;
  if (mab_) mab_->set_quality(quality);
  const EyeTarget& cast_into = mab_ ? wide_ : middle_ ? *reference_ : into[0];
  const EyeView cast_view = mab_ ? wide_view(reference, grid_) : reference;
  CastPipeline::set_eye(device_, cast_into, cast_view, placement_, scene_.volume, scene_.transfer,
                        ray_grid());
  bind();
  reset_holes(holes_);
  const CastPipeline::Resources resources = resources_of(cast_into);
  cast_rays(pipeline_, resources, cast_view, {0, 0, resources.rays_across(), resources.rays_down()}, cells);
  if (!middle_ || mab_) {  // with an atlas it says whose layers a pixel has, too
    step("closing", [&] {
      pipeline_.record_closing(commands_, resources, {0, 0, cast_into.width_px, cast_into.height_px});
    });
  }
  if (mab_ && !middle_) step("closing", [&] { cut_out(into[0]); });
  if (middle_) {
    record_view(reference, eyes.left, into[0]);
    submit_part();  // the next view has the same parameters
  }
  record_view(reference, eyes.right, into[1]);
  return finish([&] { return work_of_frame(cells); }, cells);
}

WorkCounts ByNovelView::work_of_frame(const Cells* cells) {
  const WorkCounts fresh = counted_holes(holes_);
  WorkCounts work = fresh;
  if (cells == nullptr) work += counted_rays(pipeline_);
  work.texels = view_.counted().segments;
  fresh_rays_ += static_cast<std::int64_t>(fresh.rays);
  view_.reset_counters();
  return work;
}

std::uint64_t ByNovelView::rays_max() const {
  const auto count = [](const RayBuffers& rays) {
    return static_cast<std::uint64_t>(rays.across) * static_cast<std::uint64_t>(rays.down);
  };
  return std::max(count(rays_), mab_ ? count(mab_->rays()) : 0);
}

std::string ByNovelView::note() const {
  return fresh_rays_note(fresh_rays_, frames_);
}

}  // namespace brace
