#pragma once

#include "base/error.hpp"
#include "runtime/host/native_stage.hpp"

namespace brace {

/// A live stage of a kind without device work (predict, control), active. Throws input_error for a stage that
/// is a manifest only, device_error when it fails.
inline NativeStage live_stage(const PipelineStage& chosen) {
  if (chosen.stage.native == nullptr) {
    throw input_error(
        "{}: stage {} is a manifest; accepted for pipeline.{}: built-in stages and shared libraries",
        chosen.stage.origin.string(), chosen.stage.id(), chosen.stage.family);
  }
  NativeStage stage(chosen);
  stage.activate();
  return stage;
}

}  // namespace brace
