#pragma once

#include "base/error.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// A live native stage of a kind without device work (predict, control, cost): created from its descriptor,
/// destroyed with this object.
class StageInstance {
 public:
  explicit StageInstance(const PipelineStage& chosen) : descriptor_(chosen.stage.native) {
    if (descriptor_ == nullptr)
      throw input_error("stage {} cannot be run by the host alone", chosen.stage.id());
    self_ = descriptor_->create(chosen.values.data(), static_cast<std::uint32_t>(chosen.values.size()));
    if (self_ == nullptr) throw device_error("stage {}: create failed", chosen.stage.id());
  }
  ~StageInstance() { descriptor_->destroy(self_); }
  StageInstance(const StageInstance&) = delete;
  StageInstance& operator=(const StageInstance&) = delete;

  template <typename Functions>
  const Functions* functions() const {
    return static_cast<const Functions*>(descriptor_->functions);
  }
  void* self() const { return self_; }

 private:
  const brace_stage_descriptor* descriptor_;
  void* self_ = nullptr;
};

}  // namespace brace
