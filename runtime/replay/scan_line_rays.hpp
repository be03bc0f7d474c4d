#pragma once

#include <array>

#include "runtime/frame/frame_work.hpp"
#include "runtime/gpu/commands.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/replay/headset.hpp"

namespace brace {

/// A float per pixel of an eye's picture: how far the scan-out is where the panel shows it.
gpu::Buffer scan_fraction_buffer(const gpu::Device& device, const Headset& headset, sim::Eye eye);

/// Rays that each start where the eye is when the panel shows their pixel: the truth of rolling panels. A ray
/// per pixel; between the scan-out's first and last line the head is taken to move straight. The device must
/// outlive it.
class ScanLineRays {
 public:
  ScanLineRays(const gpu::Device& device, const Headset& headset);

  /// rays/full_rate with this opening brace.
  static PipelineStage opening(PipelineStage full_rate, const std::filesystem::path& data_folder);

  /// The eye at the last line; what the pipeline is set to is the eye at the first.
  void set_last(sim::Eye eye, const EyeView& last, const VolumeInfo& volume,
                const VolumePlacement& placement) const;

  /// For the opening brace.
  std::array<gpu::Binding, 2> bindings(sim::Eye eye) const;

 private:
  const gpu::Device& device_;
  std::array<gpu::Buffer, 2> fractions_, last_;  // BraceEyeParams
};

}  // namespace brace
