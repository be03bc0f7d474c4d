#include "runtime/skip/skip_kernels.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace brace {

SkipKernels::SkipKernels(const gpu::Device& device, std::filesystem::path folder, gpu::CompileOptions options)
    : device_(&device), folder_(std::move(folder)), options_(std::move(options)) {}

const gpu::ComputePipeline& SkipKernels::get(std::string_view name, const Defines& defines) {
  std::string key(name);
  for (const auto& [macro, value] : defines)
    key += ' ' + macro + '=' + value;
  const auto found = pipelines_.find(key);
  if (found != pipelines_.end()) return found->second;
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folder_ / (std::string(name) + ".comp"));
  kernel.resolve = gpu::directory_resolver({folder_});
  kernel.defines = defines;
  return pipelines_.emplace(std::move(key), gpu::make_pipeline(*device_, kernel, options_)).first->second;
}

std::array<std::uint32_t, 3> linear_groups(std::uint64_t items, std::uint32_t local_size,
                                           std::uint32_t layers) {
  const std::uint64_t groups = std::max<std::uint64_t>((items + local_size - 1) / local_size, 1);
  constexpr std::uint64_t across_max = 32768;
  const std::uint64_t across = std::min(groups, across_max);
  return {static_cast<std::uint32_t>(across), static_cast<std::uint32_t>((groups + across - 1) / across),
          layers};
}

gpu::Binding bind_range(const gpu::Device& device, std::uint32_t slot, const gpu::Buffer& buffer,
                        std::uint64_t offset_bytes, std::uint64_t size_bytes, std::string_view what) {
  const std::uint64_t most = device.limits().storage_buffer_bytes_max;
  if (size_bytes > most) {
    throw device_error("{} takes {} bytes, but {} binds at most {} at once: larger blocks fit (block_voxels)",
                       what, size_bytes, device.info().name, most);
  }
  return gpu::bind(slot, buffer, offset_bytes, size_bytes);
}

}  // namespace brace
