#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

#include "plugins/abi/brace_stage.h"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// One object of a native stage, from create to destroy. It keeps its library loaded. A call that fails, or
/// throws against the rules, is a device_error that names the stage, its file, the call and what last_error
/// says. The calls check the state first: a wrong order is a programming error of the host.
class NativeStage {
 public:
  NativeStage() = default;
  /// Creates the stage with the values of a session; `stage.stage.native` is not null.
  explicit NativeStage(const PipelineStage& stage);
  /// Deactivates if needed, then destroys. The device must be idle.
  ~NativeStage();
  NativeStage(NativeStage&& other) noexcept { swap(other); }
  NativeStage& operator=(NativeStage&& other) noexcept {
    NativeStage(std::move(other)).swap(*this);
    return *this;
  }

  explicit operator bool() const { return self_ != nullptr; }
  const std::string& id() const { return id_; }
  /// "FILE: stage FAMILY/NAME", how messages begin.
  std::string place() const { return origin_ + ": stage " + id_; }
  std::uint32_t kind() const { return descriptor_->kind; }
  /// For those who call its functions themselves; may be null.
  const char* (*last_error() const)(void*) { return descriptor_->last_error; }
  bool is_active() const { return active_; }

  /// created → active. `activation` and everything it points to stays valid until deactivate.
  void activate(const brace_activation& activation);
  /// For the kinds without device and volume: control, predict, cost.
  void activate();
  void deactivate();

  // Once per frame, in the state active; none of them allocates unless the stage fails. Each belongs to a
  // kind.
  void open(const brace_cast_frame& frame) const;
  void close(const brace_cast_frame& frame) const;
  bool casts_on_host() const;
  void cast(const brace_cast_frame& frame) const;
  bool skips_on_host() const;
  std::uint32_t block_edge_voxels() const;
  void update_skip(const brace_skip_frame& frame) const;
  void stereo(const brace_stereo_frame& frame) const;
  void warp(const brace_warp_frame& frame) const;

  /// For the frame loop and the cost source, which call the tables themselves. The kind must be the table's.
  const brace_predict_functions& predict_functions() const;
  const brace_control_functions& control_functions() const;
  const brace_cost_functions& cost_functions() const;
  void* self() const { return self_; }

 private:
  void swap(NativeStage& other) noexcept;
  template <typename Table>
  const Table& table(brace_kind kind) const;
  template <typename Call>
  void checked(const char* what, Call&& call) const;
  [[noreturn]] void fail(const char* what, const std::string& found) const;

  std::shared_ptr<const PluginLibrary> library_;
  const brace_stage_descriptor* descriptor_ = nullptr;
  std::string id_, origin_;
  void* self_ = nullptr;
  bool active_ = false;
};

}  // namespace brace
