#include "runtime/warp_layers/novel_view.hpp"

#include <algorithm>
#include <array>

#include <glm/gtc/quaternion.hpp>

#include "base/error.hpp"
#include "plugins/abi/glsl/brace/novel_view_params.h"
#include "runtime/host/stage_glsl.hpp"

namespace brace {

namespace {

/// volumetric_store.glsl and novel_view.comp have the same.
constexpr std::uint32_t kLayersSlot = 32, kParamsSlot = 0, kImageSlot = 1, kCountersSlot = 2;

gpu::ComputePipeline novel_view_pipeline(const gpu::Device& device, const PipelineStage& warp,
                                         const NovelView::Folders& folders) {
  const std::array<const PipelineStage*, 1> stages = {&warp};
  StageGlsl glsl = stage_glsl(stages);
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folders.kernels / "novel_view.comp");
  kernel.resolve = gpu::chain_resolvers({glsl.resolve, gpu::directory_resolver({folders.glsl})});
  kernel.constants = glsl.constants;
  return gpu::make_pipeline(device, kernel);
}

std::uint64_t pixel_count(int width_px, int height_px) {
  return static_cast<std::uint64_t>(width_px) * static_cast<std::uint64_t>(height_px);
}

void set(float (&to)[4], const glm::dvec3& xyz, double w = 0.0) {
  for (int i = 0; i < 3; ++i)
    to[i] = static_cast<float>(xyz[i]);
  to[3] = static_cast<float>(w);
}

BraceNovelViewParams params_of(const EyeView& cast, const Pose& world_from_new, const NovelView::Box& box) {
  BraceNovelViewParams params{};
  const double dx = (cast.tan_right - cast.tan_left) / cast.width_px;
  const double dy = (cast.tan_bottom - cast.tan_top) / cast.height_px;
  set(params.fov, {cast.tan_left, cast.tan_top, dx}, dy);
  const Pose old_from_new = compose(inverse(cast.world_from_eye), world_from_new);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 unit(0.0);
    unit[axis] = 1.0;
    set(params.old_from_new[axis], old_from_new.orientation * unit);
  }
  set(params.old_from_new[3], old_from_new.position);
  const Pose box_from_old = compose(inverse(box.world_from_volume), cast.world_from_eye);
  const glm::dmat3 rotation = glm::mat3_cast(box_from_old.orientation);  // column by column
  for (int axis = 0; axis < 3; ++axis)
    set(params.box_from_old[axis], {rotation[0][axis], rotation[1][axis], rotation[2][axis]},
        box_from_old.position[axis]);
  set(params.box_half, {0.5 * box.edges_m[0], 0.5 * box.edges_m[1], 0.5 * box.edges_m[2]});
  params.grid[0] = static_cast<std::uint32_t>(cast.width_px);
  params.grid[1] = static_cast<std::uint32_t>(cast.height_px);
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

gpu::Binding layers_binding(const EyeTarget& target) {
  return gpu::bind(kLayersSlot, target.layers);
}

NovelView::NovelView(const gpu::Device& device, const PipelineStage& warp, int width_px, int height_px,
                     const Folders& folders)
    : device_(device),
      width_px_(width_px),
      height_px_(height_px),
      pipeline_(novel_view_pipeline(device, warp, folders)),
      params_(device, "novel view parameters", sizeof(BraceNovelViewParams), gpu::Memory::upload),
      image_(device, "novel view", pixel_count(width_px, height_px) * 4, gpu::Memory::device),
      counters_(device, "novel view counters", 3 * sizeof(std::uint32_t), gpu::Memory::readback),
      texels_(device, image_, gpu::Format::r32_uint) {
  reset_counters();
}

void NovelView::record(gpu::CommandList& commands, const EyeTarget& layers, const EyeView& cast,
                       const Pose& world_from_eye, const Box& box) {
  const BraceNovelViewParams params = params_of(cast, world_from_eye, box);
  gpu::upload_values<BraceNovelViewParams>(device_, params_, std::span(&params, 1));
  commands.barrier();
  const std::array bindings = {gpu::bind(kParamsSlot, params_), gpu::bind(kImageSlot, image_),
                               gpu::bind(kCountersSlot, counters_), layers_binding(layers)};
  const auto groups = [](int px) { return static_cast<std::uint32_t>((px + 7) / 8); };
  commands.dispatch(pipeline_, bindings, {}, {groups(width_px_), groups(height_px_), 1});
  commands.barrier();
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
