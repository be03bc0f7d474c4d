#include "runtime/warp_layers/novel_view.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "base/error.hpp"
#include "plugins/abi/glsl/brace/novel_view_params.h"
#include "runtime/host/stage_glsl.hpp"

namespace brace {

namespace {

/// brace/layers.glsl and novel_view.comp have the same.
constexpr std::uint32_t kLayersSlot = 32, kLayerRaysSlot = 33, kParamsSlot = 0, kImageSlot = 1,
                        kCountersSlot = 2, kDepthSlot = 3, kHolesSlot = 4, kScanSlot = 5;

gpu::ComputePipeline novel_view_pipeline(const gpu::Device& device, const PipelineStage& stage,
                                         const NovelView::Folders& folders, bool by_ray, bool marks_holes) {
  const std::array<const PipelineStage*, 1> stages = {&stage};
  StageGlsl glsl = stage_glsl(stages);
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folders.kernels / "novel_view.comp");
  kernel.resolve = gpu::chain_resolvers({glsl.resolve, gpu::directory_resolver({folders.glsl})});
  kernel.constants = glsl.constants;
  kernel.defines.emplace_back("BRACE_LAYERS_COUNT", stage.stage.family + "_layers");
  kernel.defines.emplace_back("BRACE_LAYERS_STEPS", stage.stage.family + "_steps");
  if (by_ray) kernel.defines.emplace_back("BRACE_LAYERS_BY_RAY", "1");
  if (marks_holes) kernel.defines.emplace_back("BRACE_NOVEL_HOLES", "1");
  return gpu::make_pipeline(device, kernel);
}

void set(float (&to)[4], const glm::dvec3& xyz, double w = 0.0) {
  for (int i = 0; i < 3; ++i)
    to[i] = static_cast<float>(xyz[i]);
  to[3] = static_cast<float>(w);
}

void set_tangents(float (&to)[4], const EyeView& eye, const RayGrid& grid) {
  const double dx = (eye.tan_right - eye.tan_left) / eye.width_px;
  const double dy = (eye.tan_bottom - eye.tan_top) / eye.height_px;
  set(to, {eye.tan_left - grid.left * dx, eye.tan_top - grid.top * dy, dx}, dy);
}

void set_pose(float (&to)[4][4], const Pose& old_from_new) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 unit(0.0);
    unit[axis] = 1.0;
    set(to[axis], old_from_new.orientation * unit);
  }
  set(to[3], old_from_new.position);
}

BraceNovelViewParams params_of(const LayerSource& from, const EyeView& eye, const NovelView::Box& box) {
  BraceNovelViewParams params{};
  set_tangents(params.fov, eye, {});
  set_tangents(params.rays, from.eye, from.rays);
  set_pose(params.old_from_new, compose(inverse(from.eye.world_from_eye), eye.world_from_eye));
  set_pose(params.old_from_last, compose(inverse(from.eye.world_from_eye), eye.world_from_eye));
  const Pose box_from_old = compose(inverse(box.world_from_volume), from.eye.world_from_eye);
  const glm::dmat3 rotation = glm::mat3_cast(box_from_old.orientation);  // column by column
  for (int axis = 0; axis < 3; ++axis)
    set(params.box_from_old[axis], {rotation[0][axis], rotation[1][axis], rotation[2][axis]},
        box_from_old.position[axis]);
  set(params.box_half, {0.5 * box.edges_m[0], 0.5 * box.edges_m[1], 0.5 * box.edges_m[2]});
  const int grid[4] = {eye.width_px, eye.height_px, from.rays.across, from.rays.down};
  for (int i = 0; i < 4; ++i)
    params.grid[i] = static_cast<std::uint32_t>(grid[i]);
  return params;
}

}  // namespace

bool takes_layers(const PipelineStage& warp) {
  const auto& inputs = warp.stage.inputs;
  return warp.stage.native == nullptr && std::find(inputs.begin(), inputs.end(), "layers") != inputs.end();
}

int layer_count_of(const PipelineStage& warp) {
  return takes_layers(warp) ? static_cast<int>(warp.value("layers")) : 0;
}

bool layers_of_equal_shares(const PipelineStage& warp) {
  PipelineStage equal = warp;
  return equal.set_choice("layering", "equal") && equal.values == warp.values;
}

gpu::Binding layers_binding(const gpu::Buffer& layers) {
  return gpu::bind(kLayersSlot, layers);
}

gpu::Binding layer_rays_binding(const EyeTarget& target) {
  return gpu::bind(kLayerRaysSlot, target.layer_rays);
}

LayerSource layer_source(const EyeTarget& target, const EyeView& eye) {
  return {target.layers,
          eye,
          {target.width_px, target.height_px},
          target.layer_rays ? &target.layer_rays : nullptr};
}

NovelView::NovelView(const gpu::Device& device, const PipelineStage& stage, const Folders& folders,
                     bool by_ray, bool marks_holes)
    : device_(device),
      pipeline_(novel_view_pipeline(device, stage, folders, by_ray, marks_holes)),
      params_(device, "novel view parameters", sizeof(BraceNovelViewParams), gpu::Memory::upload),
      counters_(device, "novel view counters", 3 * sizeof(std::uint32_t), gpu::Memory::readback) {
  reset_counters();
}

void NovelView::dispatch(gpu::CommandList& commands, const LayerSource& from, const EyeView& eye,
                         const EyeTarget& into, const gpu::Binding* more) {
  commands.barrier();
  std::vector<gpu::Binding> bindings = {gpu::bind(kParamsSlot, params_), gpu::bind(kImageSlot, into.image),
                                        gpu::bind(kDepthSlot, into.depth),
                                        gpu::bind(kCountersSlot, counters_), layers_binding(from.layers)};
  if (from.ray_of_pixel != nullptr) bindings.push_back(gpu::bind(kLayerRaysSlot, *from.ray_of_pixel));
  if (more != nullptr) bindings.push_back(*more);
  const auto groups = [](int px) { return static_cast<std::uint32_t>((px + 7) / 8); };
  commands.dispatch(pipeline_, bindings, {}, {groups(eye.width_px), groups(eye.height_px), 1});
  commands.barrier();
}

void NovelView::record(gpu::CommandList& commands, const LayerSource& from, const EyeView& eye,
                       const EyeTarget& into, const Box& box, const gpu::Buffer* holes) {
  const BraceNovelViewParams params = params_of(from, eye, box);
  gpu::upload_values<BraceNovelViewParams>(device_, params_, std::span(&params, 1));
  const std::optional<gpu::Binding> marks =
      holes != nullptr ? std::optional(gpu::bind(kHolesSlot, *holes)) : std::nullopt;
  dispatch(commands, from, eye, into, marks ? &*marks : nullptr);
}

void NovelView::record_by_line(gpu::CommandList& commands, const LayerSource& from, const EyeView& eye,
                               const Scan& scan, const EyeTarget& into, const Box& box) {
  BraceNovelViewParams params = params_of(from, eye, box);
  const Pose old_from_world = inverse(from.eye.world_from_eye);
  set_pose(params.old_from_new, compose(old_from_world, scan.world_from_first_line));
  set_pose(params.old_from_last, compose(old_from_world, scan.world_from_last_line));
  gpu::upload_values<BraceNovelViewParams>(device_, params_, std::span(&params, 1));
  const gpu::Binding fractions = gpu::bind(kScanSlot, scan.fractions);
  dispatch(commands, from, eye, into, &fractions);
}

NovelView::Counts NovelView::counted() const {
  std::array<std::uint32_t, 3> counts{};
  gpu::download_values<std::uint32_t>(device_, counters_, counts);
  return {counts[0], counts[1], counts[2]};
}

void NovelView::reset_counters() const {
  const std::array<std::uint32_t, 3> zero{};
  gpu::upload_values<std::uint32_t>(device_, counters_, zero);
}

}  // namespace brace
