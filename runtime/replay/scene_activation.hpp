#pragma once

#include "runtime/host/native_stage.hpp"
#include "runtime/host/stage_activation.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scene.hpp"

namespace brace {

/// What a session's native stages are activated with. What it points to is the scene's and must outlive it.
ActivationInput scene_activation(const gpu::Device& device, const Session& session, const Headset& headset,
                                 const SceneOnDevice& scene, const VolumePlacement& placement);

/// A native stage with its own activation, active. Throws device_error when it cannot be activated, and the
/// reader's own error when the volume could not be read for it.
class ActiveStage {
 public:
  ActiveStage(const PipelineStage& stage, const ActivationInput& input);

  const NativeStage& operator*() const { return stage_; }
  const NativeStage* operator->() const { return &stage_; }

 private:
  StageActivation activation_;
  NativeStage stage_;  // deactivated before its activation goes
};

}  // namespace brace
