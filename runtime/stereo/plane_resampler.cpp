#include "runtime/stereo/plane_resampler.hpp"

#include <array>

#include "base/error.hpp"
#include "plugins/abi/glsl/brace/plane_params.h"

namespace brace {

namespace {

/// resample_plane.comp has the same.
constexpr std::uint32_t kPlaneParamsSlot = 0, kPlaneFromImageSlot = 1, kPlaneFromDepthSlot = 2,
                        kPlaneImageSlot = 3, kPlaneDepthSlot = 4;

gpu::ComputePipeline resample_pipeline(const gpu::Device& device, const PlaneResampler::Folders& folders) {
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folders.kernels / "resample_plane.comp");
  kernel.resolve = gpu::directory_resolver({folders.glsl});
  return gpu::make_pipeline(device, kernel);
}

BracePlaneParams plane_params(const EyeView& from, const EyeView& to) {
  const glm::dquat from_to = glm::conjugate(from.world_from_eye.orientation) * to.world_from_eye.orientation;
  const double dx = (to.tan_right - to.tan_left) / to.width_px;
  const double dy = (to.tan_top - to.tan_bottom) / to.height_px;
  const std::array<glm::dvec3, 3> columns = {from_to * glm::dvec3(to.tan_left, to.tan_top, -1.0),
                                             from_to * glm::dvec3(dx, 0.0, 0.0),
                                             from_to * glm::dvec3(0.0, -dy, 0.0)};
  BracePlaneParams params{};
  const std::array<float(*)[4], 3> rows = {&params.base, &params.across, &params.down};
  for (std::size_t i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis)
      (*rows[i])[axis] = static_cast<float>(columns[i][axis]);
  params.place[0] = static_cast<float>(from.tan_left);
  params.place[1] = static_cast<float>(from.tan_top);
  params.place[2] = static_cast<float>(from.width_px / (from.tan_right - from.tan_left));
  params.place[3] = static_cast<float>(-from.height_px / (from.tan_top - from.tan_bottom));
  const std::array<int, 4> sizes = {from.width_px, from.height_px, to.width_px, to.height_px};
  for (std::size_t i = 0; i < 4; ++i)
    params.sizes[i] = static_cast<std::uint32_t>(sizes[i]);
  return params;
}

}  // namespace

PlaneResampler::PlaneResampler(const gpu::Device& device, const EyeView& from, const EyeView& to,
                               const Folders& folders)
    : width_px_(to.width_px),
      height_px_(to.height_px),
      pipeline_(resample_pipeline(device, folders)),
      params_(device, "plane parameters", sizeof(BracePlaneParams), gpu::Memory::upload) {
  const BracePlaneParams params = plane_params(from, to);
  gpu::upload_values(device, params_, std::span<const BracePlaneParams>(&params, 1));
}

void PlaneResampler::record(gpu::CommandList& commands, const EyeTarget& from, const EyeTarget& to) const {
  const std::array bindings = {gpu::bind(kPlaneParamsSlot, params_),
                               gpu::bind(kPlaneFromImageSlot, from.image),
                               gpu::bind(kPlaneFromDepthSlot, from.depth),
                               gpu::bind(kPlaneImageSlot, to.image), gpu::bind(kPlaneDepthSlot, to.depth)};
  commands.dispatch(pipeline_, bindings, {}, pipeline_.groups_for(width_px_, height_px_));
}

}  // namespace brace
