#pragma once

#include <memory>

#include "runtime/replay/scene_activation.hpp"
#include "runtime/skip/distance_maps.hpp"
#include "runtime/skip/skip_structure.hpp"

namespace brace {

/// The distance map of a native skip stage, as brace/skip_distance.glsl reads it. Everything given must
/// outlive it.
class NativeSkip final : public SkipStructure {
 public:
  /// `stage` is active.
  NativeSkip(SkipKernels& kernels, const SkipScene& scene, std::unique_ptr<ActiveStage> stage);

  /// A stage that updates on the host has done so when this returns.
  WorkCounts update(gpu::CommandList& commands, const TransferTable& table) override;
  std::uint64_t device_bytes() const override { return map_.device_bytes(); }

 private:
  std::unique_ptr<ActiveStage> stage_;
  DistanceMaps map_;
  std::vector<std::byte> host_map_;  // where the device's memory is not mapped
};

}  // namespace brace
