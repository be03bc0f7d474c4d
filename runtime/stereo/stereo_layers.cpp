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
                        kHolesSlot = 20, kColoursSlot = 21, kDepthsSlot = 22;

gpu::ComputePipeline second_eye_pipeline(const gpu::Device& device, const PipelineStage& stage,
                                         const StereoPlan& plan, const StereoLayers::Folders& folders) {
  const std::array<const PipelineStage*, 1> stages = {&stage};
  StageGlsl glsl = stage_glsl(stages);
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folders.kernels / (plan.layers_left_out ? "shift.comp" : "compose.comp"));
  kernel.resolve = gpu::chain_resolvers({glsl.resolve, gpu::directory_resolver({folders.glsl})});
  kernel.constants = glsl.constants;
  if (plan.levels > 0) kernel.defines.emplace_back("BRACE_STEREO_BY_TEXEL", "1");
  return gpu::make_pipeline(device, kernel);
}

void set(float (&to)[4], double x, double y, double z = 0.0, double w = 0.0) {
  const double from[4] = {x, y, z, w};
  for (int i = 0; i < 4; ++i)
    to[i] = static_cast<float>(from[i]);
}

BraceStereoParams params_of(const StereoPlan& plan, const StereoPicture& picture,
                            const BraceStereoParams& common, double unit_m, std::uint32_t frame) {
  BraceStereoParams params = common;
  const StereoPair& pair = picture.pair;
  const StereoGeometry& geometry = pair.geometry;
  const double columns = plan.layers_left_out ? 1.0 : plan.settings.columns_per_pixel();
  set(params.line, columns * geometry.pixels_per_ray, columns * geometry.shift_px,
      columns * geometry.disparity_px_m / unit_m);
  set(params.columns, columns, picture.columns);
  set(params.tangents, pair.tangents.left, pair.tangents.per_column, pair.tangents.top,
      pair.tangents.per_row);
  set(params.rows, geometry.rows_per_row, geometry.row_shift);
  const std::int32_t grid[4] = {picture.left, picture.top, picture.across, picture.down};
  std::copy(std::begin(grid), std::end(grid), std::begin(params.grid));
  const std::uint32_t layers[4] = {static_cast<std::uint32_t>(picture.layers), frame,
                                   static_cast<std::uint32_t>(pair.width_px),
                                   static_cast<std::uint32_t>(pair.height_px)};
  std::copy(std::begin(layers), std::end(layers), std::begin(params.layers));
  const std::uint32_t first[4] = {static_cast<std::uint32_t>(picture.first_texel),
                                  static_cast<std::uint32_t>(picture.first_ray), pair.is_mirrored ? 1u : 0u,
                                  static_cast<std::uint32_t>(std::max(plan.levels, 1))};
  std::copy(std::begin(first), std::end(first), std::begin(params.first));
  return params;
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
  settings.from_middle = stage.value("reference") == 1.0;
  return settings;
}

StereoLayers::StereoLayers(const gpu::Device& device, const PipelineStage& stage, const StereoPlan& plan,
                           const Folders& folders)
    : device_(device),
      plan_(plan),
      rays_(plan.levels > 0 ? RayBuffers() : RayBuffers(device, plan.across, plan.down)),
      params_(device, "stereo parameters", plan.pictures.size() * sizeof(BraceStereoParams),
              gpu::Memory::upload),
      second_eye_(second_eye_pipeline(device, stage, plan, folders)) {
  for (const StereoPicture& picture : plan.pictures) {
    if (picture.columns <= 65535) continue;
    throw input_error("stage stereo/layers: layers are {} columns wide; accepted: up to 65535",
                      picture.columns);
  }
  bindings_ = {gpu::bind(kParamsSlot, params_)};
  if (plan.layers_left_out) return;
  texels_ = gpu::Buffer(device, "stereo layers", plan.bytes, gpu::Memory::device);
  ranges_ = gpu::Buffer(device, "stereo ranges", plan.rays * 8, gpu::Memory::device);
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

/// Whether the layers and the rays beside the picture are enough; sets those that are cast.
bool StereoLayers::fits(DepthRange depths) {
  area_ = {plan_.margins.left, 0, plan_.width_px, plan_.down};
  int left = 0, right = 0;
  for (const StereoPicture& picture : plan_.pictures) {
    const StereoGeometry& geometry = picture.pair.geometry;
    const double range_px = disparity_range_px(geometry.optics, depths.near_m, depths.far_m);
    if (plan_.layers_left_out ? !(range_px < 1.0)
                              : layers_for(plan_.settings, geometry, range_px) > picture.layers)
      return false;
    if (plan_.levels > 0) continue;
    // The margins were made for the near plane, but need not be cast farther than the eyes see.
    RayMargins needed = ray_margins(geometry, plan_.width_px, plan_.height_px, depths);
    const int made_right = picture.across - picture.left - plan_.width_px;
    if (needed.right > made_right) return false;
    needed.left = std::min(needed.left, picture.left);
    left = std::max(left, picture.pair.is_mirrored ? needed.right : needed.left);
    right = std::max(right, picture.pair.is_mirrored ? needed.left : needed.right);
  }
  area_.x -= left;
  area_.width += left + right;
  return true;
}

bool StereoLayers::begin_frame(const EyeView& reference, const VolumeInfo& volume,
                               const VolumePlacement& placement) {
  DepthRange depths = depth_range(reference, volume, placement);
  // Behind the eyes: no ray meets it, whatever the depths.
  if (depths.far_m <= 0.0) depths = {plan_.near_m, plan_.near_m};
  if (!(depths.near_m > 0.0) || !fits(depths)) return false;
  if (frame_ == 0xffff) {
    if (ranges_) clear_ranges();  // else those of 65535 frames ago would count
    frame_ = 0;
  }
  ++frame_;
  const double unit_m = metres_per_unit(volume, placement);
  BraceStereoParams common{};
  const glm::dvec3 forward = glm::conjugate(placement.world_from_volume.orientation) *
                             (reference.world_from_eye.orientation * glm::dvec3(0.0, 0.0, -1.0));
  set(common.forward, forward.x, forward.y, forward.z);
  set(common.depths, depths.near_m / unit_m, depths.far_m / unit_m);
  std::vector<BraceStereoParams> params;
  for (const StereoPicture& picture : plan_.pictures)
    params.push_back(params_of(plan_, picture, common, unit_m, frame_));
  gpu::upload_values(device_, params_, std::span<const BraceStereoParams>(params));
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

void StereoLayers::record_composed(gpu::CommandList& commands, std::size_t eye, const Composed& into) const {
  std::vector<gpu::Binding> bindings = bindings_;
  bindings.push_back(gpu::bind(CastSlot::eye, into.target.params));
  int across = plan_.width_px, down = plan_.height_px;
  if (into.atlas != nullptr) {
    bindings.push_back(
        gpu::bind(kColoursSlot, into.colours != nullptr ? *into.colours : into.atlas->colours));
    bindings.push_back(
        gpu::bind(kDepthsSlot, into.depths_m != nullptr ? *into.depths_m : into.atlas->depths_m));
    bindings.insert(bindings.end(), into.of_atlas.begin(), into.of_atlas.end());
    across = into.grid.across;
    down = into.grid.down;
  } else {
    bindings.push_back(gpu::bind(CastSlot::result_colour, rays_.colours));
    bindings.push_back(gpu::bind(CastSlot::result_depth, rays_.depths_m));
    bindings.push_back(gpu::bind(CastSlot::eye_image, into.target.image));
    bindings.push_back(gpu::bind(CastSlot::eye_depth, into.target.depth));
  }
  if (into.holes != nullptr) bindings.push_back(gpu::bind(kHolesSlot, *into.holes));
  const BraceArea area{{static_cast<std::uint32_t>(eye * pictures_per_eye()), 0},
                       {static_cast<std::uint32_t>(across), static_cast<std::uint32_t>(down)}};
  commands.dispatch(second_eye_, bindings, gpu::push_bytes(area), second_eye_.groups_for(across, down));
}

}  // namespace brace
