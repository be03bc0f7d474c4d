#include "runtime/mab/mab_braces.hpp"

#include <algorithm>
#include <utility>

#include "plugins/abi/glsl/brace/mab_params.h"

namespace brace {

namespace {

/// Binding slots of the snippet; mab.glsl is the same list.
constexpr std::uint32_t params_slot = 24, texel_of_ray_slot = 25, ray_of_texel_slot = 26,
                        coordinates_slot = 27, weights_slot = 28, ranges_slot = 29;

BraceMabParams mab_params(const Atlas& atlas) {
  BraceMabParams params{};
  params.counts[0] = static_cast<std::uint32_t>(atlas.levels.size());
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < atlas.levels.size(); ++i) {
    params.level[i][0] = static_cast<std::uint32_t>(atlas.levels[i].width);
    params.level[i][1] = static_cast<std::uint32_t>(atlas.levels[i].height);
    params.level[i][2] = first;
    first += params.level[i][0] * params.level[i][1];
  }
  return params;
}

std::uint64_t texels_of(const Atlas& atlas) {
  const BraceMabParams params = mab_params(atlas);
  const auto& last = params.level[atlas.levels.size() - 1];
  return std::uint64_t{last[2]} + std::uint64_t{last[0]} * last[1];
}

}  // namespace

MabBraces::MabBraces(const gpu::Device& device, MabPlan plan, std::uint64_t guard_bytes)
    : device_(device),
      plan_(std::move(plan)),
      rays_(device, 64, static_cast<int>((plan_.capacity() + 63) / 64), guard_bytes),
      params_(device, "mab parameters", sizeof(BraceMabParams), gpu::Memory::upload) {
  const BraceMabParams params = mab_params(plan_.atlas());
  gpu::upload_values(device, params_, std::span<const BraceMabParams>(&params, 1));
  const auto ray_cells = static_cast<std::uint64_t>(rays_.across) * static_cast<std::uint64_t>(rays_.down);
  for (const sim::Eye which : sim::all_eyes) {
    EyeBraces& eye = eyes_[static_cast<std::size_t>(which)];
    const std::vector<float>& coordinates = plan_.coordinates(which);
    eye.texel_of_ray = gpu::Buffer(device, "mab texels", ray_cells * 4, gpu::Memory::upload);
    eye.ray_of_texel = gpu::Buffer(device, "mab rays", texels_of(plan_.atlas()) * 4, gpu::Memory::upload);
    eye.coordinates = gpu::Buffer(device, "mab coordinates", coordinates.size() * 4, gpu::Memory::device);
    eye.weights = gpu::Buffer(device, "mab weights", sizeof(float) * mab_levels_max * mab_weight_entries,
                              gpu::Memory::upload);
    eye.ranges = gpu::Buffer(device, "mab levels per entry", sizeof(std::uint32_t) * mab_weight_entries,
                             gpu::Memory::upload);
    gpu::upload_values(device, eye.coordinates, std::span<const float>(coordinates));
    eye.bindings = {gpu::bind(params_slot, params_),
                    gpu::bind(texel_of_ray_slot, eye.texel_of_ray),
                    gpu::bind(ray_of_texel_slot, eye.ray_of_texel),
                    gpu::bind(coordinates_slot, eye.coordinates),
                    gpu::bind(weights_slot, eye.weights),
                    gpu::bind(ranges_slot, eye.ranges)};
  }
  show_step(plan_.step_asked(1.0));
}

void MabBraces::look_at(const glm::dvec3& gaze) {
  if (!plan_.look_at(gaze)) return;
  for (const sim::Eye which : sim::all_eyes) {
    const std::vector<float>& coordinates = plan_.coordinates(which);
    gpu::upload_values(device_, eyes_[static_cast<std::size_t>(which)].coordinates,
                       std::span<const float>(coordinates));
  }
  step_ = -1;
}

void MabBraces::set_quality(double quality) {
  const int step = plan_.step_asked(quality);
  if (step != step_) show_step(step);
}

void MabBraces::show_step(int step) {
  step_ = step;
  for (const sim::Eye which : sim::all_eyes) {
    EyeBraces& eye = eyes_[static_cast<std::size_t>(which)];
    const LevelWeights weights = plan_.weights(which, step);
    gpu::upload_values(device_, eye.weights, std::span<const float>(weights.entries));
    gpu::upload_values(device_, eye.ranges, std::span<const std::uint32_t>(weights.ranges));
    const MabRays rays = plan_.make_rays(which, step);
    gpu::upload_values(device_, eye.texel_of_ray, std::span<const std::uint32_t>(rays.texel_of_ray));
    gpu::upload_values(device_, eye.ray_of_texel, std::span<const std::uint32_t>(rays.ray_of_texel));
    eye.grid = {rays.across, rays.down};
  }
}

}  // namespace brace
