#pragma once

#include <array>
#include <span>
#include <vector>

#include "runtime/mab/mab_plan.hpp"
#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

/// rays/mab on the device: the ray buffers that both eyes share, and for each eye what the stage's snippet
/// binds. The device must outlive it; nothing submitted may be waiting when quality or gaze are set.
class MabBraces {
 public:
  /// Throws device_error when the rays do not fit.
  MabBraces(const gpu::Device& device, MabPlan plan, std::uint64_t guard_bytes = 0);

  const MabPlan& plan() const { return plan_; }
  const RayBuffers& rays() const { return rays_; }

  /// See MabPlan::look_at; set_quality comes after it.
  void look_at(const glm::dvec3& gaze);

  /// Moves the anchors so that at most this share of what the plan gives is cast.
  void set_quality(double quality);

  RayGrid grid(sim::Eye eye) const { return eyes_[static_cast<std::size_t>(eye)].grid; }
  std::span<const gpu::Binding> bindings(sim::Eye eye) const {
    return eyes_[static_cast<std::size_t>(eye)].bindings;
  }

 private:
  struct EyeBraces {
    gpu::Buffer texel_of_ray, ray_of_texel, coordinates, weights, ranges;
    RayGrid grid;
    std::vector<gpu::Binding> bindings;
  };
  void show_step(int step);

  const gpu::Device& device_;
  MabPlan plan_;
  RayBuffers rays_;
  gpu::Buffer params_;
  std::array<EyeBraces, 2> eyes_;
  int step_ = -1;
};

}  // namespace brace
