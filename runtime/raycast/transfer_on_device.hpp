#pragma once

#include <cstdint>

#include "plugins/abi/glsl/brace/eye_params.h"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/memory.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {

/// What is kept of a transfer function beside its table (brace/transfer_integral.glsl).
struct TransferExtras {
  bool integrals = false;  // pre-integrated in one dimension
  bool segments = false;   // and in two
};

/// A transfer table in a texel buffer, with a step length baked into it. The device must outlive it.
class TransferOnDevice {
 public:
  TransferOnDevice() = default;

  /// `step_units` > 0: distance between samples in the smallest voxel spacing.
  TransferOnDevice(const gpu::Device& device, const TransferTable& table, double step_units,
                   TransferExtras extras = {});

  /// Replaces the table and what is derived from it; no submitted work may still read it. Takes no new device
  /// memory as long as the number of entries stays.
  void update(const gpu::Device& device, const TransferTable& table, double step_units);

  gpu::Binding binding(std::uint32_t slot) const { return gpu::bind(slot, texels_); }
  /// Of the extras; without them a texel that no kernel asks for.
  gpu::Binding integrals_binding(std::uint32_t slot) const { return gpu::bind(slot, integral_texels_); }
  gpu::Binding segments_binding(std::uint32_t slot) const { return gpu::bind(slot, segment_texels_); }
  const gpu::Buffer& buffer() const { return buffer_; }

  /// Fills transfer.
  void describe(BraceEyeParams& params) const;

 private:
  void update_extras(const gpu::Device& device, const TransferTable& table, double step_units);

  TransferExtras extras_;
  gpu::Buffer buffer_, integrals_, segments_;
  gpu::TexelBuffer texels_, integral_texels_, segment_texels_;
  float coordinate_scale_ = 1.0f;
  float coordinate_offset_ = 0.0f;
  float last_entry_ = 1.0f;
  float empty_up_to_ = 0.0f;
};

}  // namespace brace
