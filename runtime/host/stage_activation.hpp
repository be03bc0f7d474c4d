#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <vector>

#include "base/pose.hpp"
#include "plugins/abi/brace_stage.h"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/device.hpp"
#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {

brace_pose to_abi(const Pose& pose);
Pose from_abi(const brace_pose& pose);

/// A buffer, or a part of it, as a stage sees it. `size_bytes` 0: to the end.
brace_buffer_range buffer_range(const gpu::Buffer& buffer, std::uint64_t offset_bytes = 0,
                                std::uint64_t size_bytes = 0);

/// What native stages of one session are activated with.
struct ActivationInput {
  const gpu::Device* device = nullptr;  // null: stages that need none
  std::uint32_t eye_width_px = 0, eye_height_px = 0;
  std::uint32_t ray_count_max = 0;

  const VolumeInfo* volume = nullptr;
  /// Opens the volume anew, for stages that read voxels on the host.
  std::function<std::unique_ptr<VolumeSource>()> open_volume;
  brace_volume_layout layout = BRACE_VOLUME_LAYOUT_IMAGE;
  gpu::Binding volume_on_device;  // texels, or image and sampler
  double metres_per_unit = 1.0;
  Pose world_from_volume;

  const TransferTable* transfer = nullptr;
  double step_units = 0.5;
  brace_shading shading = BRACE_SHADING_NONE;
  std::uint32_t shading_samples = 0;
  double shading_step_units = 0.0;
  glm::dvec3 shading_light{0.0};  // length 1, volume's metric axes
};

/// Owns everything a brace_activation points to. Lives at least as long as the stages it activates are
/// active; what `input` points to must outlive it.
class StageActivation {
 public:
  explicit StageActivation(const ActivationInput& input);
  StageActivation(const StageActivation&) = delete;
  StageActivation& operator=(const StageActivation&) = delete;

  const brace_activation& get() const { return activation_; }
  const brace_transfer_table& transfer() const { return transfer_; }

  /// Reading voxels for a stage may fail with the file: the reader's own error, which says more than the
  /// stage's, is kept here. Call after an activate that failed.
  void rethrow_read_error() const;

 private:
  static brace_result read_slices(const brace_volume* volume, std::uint32_t z_begin, std::uint32_t z_count,
                                  void* voxels, std::uint64_t size_bytes);
  void read(std::uint32_t z_begin, std::uint32_t z_count, void* voxels);
  void describe_volume(const ActivationInput& input);

  brace_activation activation_{};
  brace_vulkan vulkan_{};
  brace_volume volume_{};
  brace_transfer_table transfer_{};
  std::function<std::unique_ptr<VolumeSource>()> open_;
  std::unique_ptr<VolumeSource> source_;
  std::exception_ptr read_error_;
};

}  // namespace brace
