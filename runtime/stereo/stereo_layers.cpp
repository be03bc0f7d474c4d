#include "runtime/stereo/stereo_layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "plugins/abi/glsl/brace/stereo_params.h"
#include "runtime/host/stage_glsl.hpp"

namespace brace {

namespace {

/// Binding slots of the snippet and of the kernels here; layers_store.glsl is the same list.
constexpr std::uint32_t kParamsSlot = 16, kTexelsSlot = 17, kRangesSlot = 18, kCountsSlot = 19,
                        kHolesSlot = 20;

gpu::ComputePipeline second_eye_pipeline(const gpu::Device& device, const PipelineStage& stage,
                                         bool layers_left_out, const StereoLayers::Folders& folders) {
  const std::array<const PipelineStage*, 1> stages = {&stage};
  StageGlsl glsl = stage_glsl(stages);
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folders.kernels / (layers_left_out ? "shift.comp" : "compose.comp"));
  kernel.resolve = gpu::chain_resolvers({glsl.resolve, gpu::directory_resolver({folders.glsl})});
  kernel.constants = glsl.constants;
  return gpu::make_pipeline(device, kernel);
}

std::uint64_t product(int a, int b) {
  return static_cast<std::uint64_t>(a) * static_cast<std::uint64_t>(b);
}

void set(float (&to)[4], double x, double y, double z = 0.0, double w = 0.0) {
  const double from[4] = {x, y, z, w};
  for (int i = 0; i < 4; ++i)
    to[i] = static_cast<float>(from[i]);
}

}  // namespace

StereoSettings stereo_settings(const PipelineStage& stage) {
  constexpr std::array<int, 3> bytes = {8, 16, 4};  // in the order of the manifest's formats
  StereoSettings settings;
  settings.layers = static_cast<int>(stage.value("layers"));
  settings.near_m = stage.value("near_m");
  settings.bytes_per_texel = bytes[static_cast<std::size_t>(stage.value("format"))];
  settings.interpolates = stage.value("interpolation") == 1.0;
  settings.interleave = static_cast<int>(stage.value("interleave"));
  settings.fresh_rays = stage.value("holes") == 0.0;
  return settings;
}

StereoLayers::StereoLayers(const gpu::Device& device, const PipelineStage& stage, const StereoPlan& plan,
                           int width_px, int height_px, const Folders& folders)
    : device_(device),
      plan_(plan),
      width_px_(width_px),
      height_px_(height_px),
      rays_(device, plan.across, plan.down),
      params_(device, "stereo parameters", sizeof(BraceStereoParams), gpu::Memory::upload),
      second_eye_(second_eye_pipeline(device, stage, plan.layers_left_out, folders)) {
  if (plan.columns > 65535) {
    throw input_error("stage stereo/layers: layers are {} columns wide; accepted: up to 65535", plan.columns);
  }
  bindings_ = {gpu::bind(kParamsSlot, params_)};
  if (plan.layers_left_out) return;
  texels_ = gpu::Buffer(device, "stereo layers", plan.bytes, gpu::Memory::device);
  ranges_ = gpu::Buffer(device, "stereo ranges", product(plan.across, plan.down) * 8, gpu::Memory::device);
  counts_ = gpu::Buffer(device, "stereo counts", sizeof(Counts), gpu::Memory::readback);
  reset_counters();
  clear_ranges();
  bindings_.push_back(gpu::bind(kTexelsSlot, texels_));
  bindings_.push_back(gpu::bind(kRangesSlot, ranges_));
  bindings_.push_back(gpu::bind(kCountsSlot, counts_));
}

void StereoLayers::clear_ranges() {
  gpu::CommandList clear(device_, "clear stereo ranges");
  clear.fill(ranges_, 0);
  gpu::submit_and_wait(clear);
}

bool StereoLayers::begin_frame(const EyeViews& eyes, const VolumeInfo& volume,
                               const VolumePlacement& placement) {
  const StereoGeometry geometry = stereo_geometry(eyes.left, eyes.right);
  DepthRange depths = depth_range(eyes.left, volume, placement);
  // Behind the eyes: no ray meets it, whatever the depths.
  if (depths.far_m <= 0.0) depths = {plan_.near_m, plan_.near_m};
  if (!(depths.near_m > 0.0)) return false;
  const double range_px = disparity_range_px(geometry.optics, depths.near_m, depths.far_m);
  const bool fits =
      plan_.layers_left_out ? range_px < 1.0 : layers_for(plan_.settings, geometry, range_px) <= plan_.layers;
  const RayMargins needed = ray_margins(geometry, width_px_, height_px_, depths);
  // The margins were made for the near plane, but need not be cast farther than the second eye sees.
  if (!fits || needed.right > plan_.margins.right) return false;

  const RayMargins& made = plan_.margins;
  const int left = std::min(needed.left, made.left);
  area_ = {made.left - left, 0, left + width_px_ + needed.right, plan_.down};

  const double unit_m = metres_per_unit(volume, placement);
  const glm::dvec3 forward = glm::conjugate(placement.world_from_volume.orientation) *
                             (eyes.left.world_from_eye.orientation * glm::dvec3(0.0, 0.0, -1.0));
  BraceStereoParams params{};
  set(params.forward, forward.x, forward.y, forward.z);
  const double columns = plan_.layers_left_out ? 1.0 : plan_.settings.columns_per_pixel();
  set(params.line, columns * geometry.pixels_per_ray, columns * geometry.shift_px,
      columns * geometry.disparity_px_m / unit_m);
  set(params.columns, columns, plan_.columns);
  set(params.depths, depths.near_m / unit_m, depths.far_m / unit_m);
  set(params.tangents, eyes.right.tan_left, (eyes.right.tan_right - eyes.right.tan_left) / width_px_,
      eyes.right.tan_top, (eyes.right.tan_bottom - eyes.right.tan_top) / height_px_);
  set(params.rows, geometry.rows_per_row, geometry.row_shift);
  const std::int32_t grid[4] = {made.left, made.top, plan_.across, plan_.down};
  std::copy(std::begin(grid), std::end(grid), std::begin(params.grid));
  if (frame_ == 0xffff) {
    if (ranges_) clear_ranges();  // else those of 65535 frames ago would count
    frame_ = 0;
  }
  ++frame_;
  const std::uint32_t layers[4] = {static_cast<std::uint32_t>(plan_.layers), frame_,
                                   static_cast<std::uint32_t>(width_px_),
                                   static_cast<std::uint32_t>(height_px_)};
  std::copy(std::begin(layers), std::end(layers), std::begin(params.layers));
  gpu::upload_values(device_, params_, std::span<const BraceStereoParams>(&params, 1));
  return true;
}

StereoLayers::Counts StereoLayers::counted() const {
  std::array<std::uint32_t, 2> counts{};
  if (counts_) gpu::download_values(device_, counts_, std::span<std::uint32_t>(counts));
  return {counts[0], counts[1]};
}

void StereoLayers::reset_counters() const {
  const std::array<std::uint32_t, 2> zero{};
  if (counts_) gpu::upload_values(device_, counts_, std::span<const std::uint32_t>(zero));
}

void StereoLayers::record_second_eye(gpu::CommandList& commands, const EyeTarget& first,
                                     const EyeTarget& second, const gpu::Buffer* holes) const {
  std::vector<gpu::Binding> bindings = bindings_;
  bindings.push_back(gpu::bind(CastSlot::eye, first.params));
  bindings.push_back(gpu::bind(CastSlot::result_colour, rays_.colours));
  bindings.push_back(gpu::bind(CastSlot::result_depth, rays_.depths_m));
  bindings.push_back(gpu::bind(CastSlot::eye_image, second.image));
  bindings.push_back(gpu::bind(CastSlot::eye_depth, second.depth));
  if (holes != nullptr) bindings.push_back(gpu::bind(kHolesSlot, *holes));
  commands.dispatch(second_eye_, bindings, {}, second_eye_.groups_for(width_px_, height_px_));
}

}  // namespace brace
