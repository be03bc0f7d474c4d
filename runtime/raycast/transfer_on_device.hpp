#pragma once

#include <cstdint>

#include "plugins/abi/glsl/brace/eye_params.h"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/memory.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {

/// A transfer table in a uniform buffer, with a step length baked into it. The device must outlive it.
class TransferOnDevice {
 public:
  TransferOnDevice() = default;

  /// `step_units` > 0: distance between samples in the smallest voxel spacing.
  TransferOnDevice(const gpu::Device& device, const TransferTable& table, double step_units);

  /// Replaces the table; no submitted work may still read it. Takes no new memory.
  void update(const gpu::Device& device, const TransferTable& table, double step_units);

  gpu::Binding binding(std::uint32_t slot) const { return gpu::bind(slot, buffer_); }

  /// Fills transfer.
  void describe(BraceEyeParams& params) const;

 private:
  gpu::Buffer buffer_;
  float coordinate_scale_ = 1.0f;
  float coordinate_offset_ = 0.0f;
  float last_entry_ = 1.0f;
  float empty_up_to_ = 0.0f;
};

}  // namespace brace
