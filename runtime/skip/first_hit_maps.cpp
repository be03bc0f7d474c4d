#include "runtime/skip/first_hit_maps.hpp"

#include <cmath>
#include <numbers>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "base/error.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

namespace {

constexpr std::uint32_t slot_first_hits = 12, slot_occlusion = 13;

glm::dvec3 xyz(const float (&from)[4]) {
  return {from[0], from[1], from[2]};
}

void set_row(float (&to)[4], const glm::dvec3& row) {
  for (int axis = 0; axis < 3; ++axis)
    to[axis] = static_cast<float>(row[axis]);
}

double turn_rad(const EyeView& from, const EyeView& to) {
  const double cosine_of_half =
      std::abs(glm::dot(from.world_from_eye.orientation, to.world_from_eye.orientation));
  return 2.0 * std::acos(std::min(cosine_of_half, 1.0));
}

bool is_near(const EyeView& seen, const EyeView& next, const OcclusionSettings& settings) {
  return glm::distance(seen.world_from_eye.position, next.world_from_eye.position) <= settings.move_m_max &&
         turn_rad(seen, next) <= settings.turn_rad_max;
}

std::uint32_t tiles_along(int pixels, int tile_px) {
  return static_cast<std::uint32_t>((pixels + tile_px - 1) / tile_px);
}

}  // namespace

OcclusionSettings occlusion_settings(const PipelineStage& stage) {
  OcclusionSettings settings;
  settings.tile_px = static_cast<int>(stage.value("tile_px"));
  settings.refresh_frames = static_cast<int>(stage.value("refresh_frames"));
  settings.move_m_max = stage.value("move_m_max");
  settings.turn_rad_max = stage.value("turn_deg_max") * std::numbers::pi / 180.0;
  return settings;
}

BraceOcclusionParams occlusion_params(const EyeView& seen, const EyeView& next, const VolumeInfo& volume,
                                      const VolumePlacement& placement, const OcclusionSettings& settings,
                                      std::uint32_t frame) {
  BraceOcclusionParams params{};
  params.tiles[2] = frame;
  params.tiles[3] = static_cast<std::uint32_t>(settings.tile_px);
  params.row[3] = static_cast<float>(settings.refresh_frames);
  if (!is_near(seen, next, settings)) return params;
  params.tiles[0] = tiles_along(seen.width_px, settings.tile_px);
  params.tiles[1] = tiles_along(seen.height_px, settings.tile_px);
  // A point in front of the old eye lies at (base + u dx + v dy) w along the volume's metric axes: u and v
  // are its pixel, w its distance along the eye's axis, as base has the length 1 there.
  const BraceEyeParams eye = eye_params(seen, volume, placement);
  const glm::dvec3 dx = xyz(eye.ray_dx), dy = xyz(eye.ray_dy);
  const glm::dmat3 pixel_from_metric = glm::inverse(glm::dmat3(dx, dy, xyz(eye.ray_base)));
  const glm::dvec3 voxels_per_unit = xyz(eye.voxels_per_unit);
  const auto row = [&](int at) {
    const glm::dvec3 metric(pixel_from_metric[0][at], pixel_from_metric[1][at], pixel_from_metric[2][at]);
    return metric / voxels_per_unit;
  };
  set_row(params.column, row(0) / static_cast<double>(settings.tile_px));
  set_row(params.row, row(1) / static_cast<double>(settings.tile_px));
  set_row(params.ahead, row(2));
  params.ahead[3] = static_cast<float>(std::max(glm::length(dx), glm::length(dy)));
  set_row(params.eye, xyz(eye.eye));
  return params;
}

FirstHitMaps::FirstHitMaps(SkipKernels& kernels, const OcclusionSettings& settings, int width_px,
                           int height_px)
    : kernels_(&kernels),
      settings_(settings),
      tiles_{tiles_along(width_px, settings.tile_px), tiles_along(height_px, settings.tile_px)} {
  const gpu::Device& device = kernels.device();
  for (OfEye& eye : eyes_) {
    eye.hits =
        gpu::Buffer(device, "first hits", std::uint64_t{tiles_[0]} * tiles_[1] * 4, gpu::Memory::device);
    eye.hit_texels = gpu::TexelBuffer(device, eye.hits, gpu::Format::r32_float);
    eye.params =
        gpu::Buffer(device, "occlusion parameters", sizeof(BraceOcclusionParams), gpu::Memory::upload);
  }
}

void FirstHitMaps::aim(std::size_t eye, const EyeView& view, const VolumeInfo& volume,
                       const VolumePlacement& placement, std::int64_t transfer_version) {
  OfEye& own = eyes_[eye];
  BraceOcclusionParams params{};
  if (own.seen && own.seen->transfer_version == transfer_version)
    params = occlusion_params(own.seen->view, view, volume, placement, settings_, own.frame);
  gpu::upload_values(kernels_->device(), own.params, std::span<const BraceOcclusionParams>(&params, 1));
  own.seen.reset();
  own.aimed = View{view, transfer_version};
  own.metres_per_unit = metres_per_unit(volume, placement);
  ++own.frame;
}

std::span<const gpu::Binding> FirstHitMaps::bindings(std::size_t eye) {
  bindings_ = {gpu::bind(slot_first_hits, eyes_[eye].hit_texels),
               gpu::bind(slot_occlusion, eyes_[eye].params)};
  return bindings_;
}

void FirstHitMaps::record(gpu::CommandList& commands, std::size_t eye, const EyeTarget& target) {
  OfEye& own = eyes_[eye];
  BRACE_CHECK(own.aimed.has_value());
  struct Push {
    std::uint32_t image[4];
    std::uint32_t tiles[4];
    float scale[4];
  };
  const Push push{{static_cast<std::uint32_t>(target.width_px), static_cast<std::uint32_t>(target.height_px),
                   static_cast<std::uint32_t>(settings_.tile_px), 0},
                  {tiles_[0], tiles_[1], 0, 0},
                  {static_cast<float>(1.0 / own.metres_per_unit), 0.0f, 0.0f, 0.0f}};
  const gpu::ComputePipeline& kernel = kernels_->get("first_hits");
  commands.begin_timing("first hits");
  commands.dispatch(kernel, {gpu::bind(0, target.depth_texels), gpu::bind(1, own.hits)},
                    gpu::push_bytes(push),
                    kernel.groups_for(static_cast<int>(tiles_[0]), static_cast<int>(tiles_[1])));
  commands.barrier();
  commands.end_timing();
  own.seen = own.aimed;
}

void FirstHitMaps::forget() {
  for (OfEye& eye : eyes_)
    eye.seen.reset();
}

std::uint64_t FirstHitMaps::device_bytes() const {
  std::uint64_t bytes = 0;
  for (const OfEye& eye : eyes_)
    bytes += eye.hits.size_bytes() + eye.params.size_bytes();
  return bytes;
}

}  // namespace brace
