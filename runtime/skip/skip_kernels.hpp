#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/pipeline.hpp"

namespace brace {

using Defines = std::vector<std::pair<std::string, std::string>>;

/// The compute kernels of this folder, compiled when first asked for. The device must outlive it.
class SkipKernels {
 public:
  /// `folder`: where masks.comp and the others lie (share/brace/kernels/skip).
  SkipKernels(const gpu::Device& device, std::filesystem::path folder, gpu::CompileOptions options = {});

  /// Valid as long as this object.
  const gpu::ComputePipeline& get(std::string_view name, const Defines& defines = {});

  const gpu::Device& device() const { return *device_; }

 private:
  const gpu::Device* device_;
  std::filesystem::path folder_;
  gpu::CompileOptions options_;
  std::map<std::string, gpu::ComputePipeline, std::less<>> pipelines_;
};

/// Work-groups for `items` invocations of kernels/linear.glsl, `layers` times over.
std::array<std::uint32_t, 3> linear_groups(std::uint64_t items, std::uint32_t local_size,
                                           std::uint32_t layers = 1);

/// A part of a buffer that kernels bind as storage; throws device_error that names `what` when the device
/// does not bind so many bytes.
gpu::Binding bind_range(const gpu::Device& device, std::uint32_t slot, const gpu::Buffer& buffer,
                        std::uint64_t offset_bytes, std::uint64_t size_bytes, std::string_view what);

}  // namespace brace
