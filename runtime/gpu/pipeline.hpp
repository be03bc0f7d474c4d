#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/gpu/shader_compiler.hpp"
#include "runtime/gpu/vulkan_handles.hpp"

namespace brace::gpu {

/// How a kernel declares a binding; read from the SPIR-V.
enum class BindingKind {
  storage_buffer,        // buffer
  uniform_buffer,        // uniform block
  uniform_texel_buffer,  // samplerBuffer, usamplerBuffer
  storage_texel_buffer,  // imageBuffer, uimageBuffer
  sampled_image,         // sampler2D, sampler3D
  storage_image,         // image2D, image3D
};

const char* to_string(BindingKind kind);

/// What a kernel needs of its surroundings; read from the SPIR-V.
struct KernelInterface {
  struct Binding {
    std::uint32_t slot = 0;
    BindingKind kind = BindingKind::storage_buffer;
    std::string name;
    bool operator==(const Binding&) const = default;
  };
  std::vector<Binding> bindings;          // ascending slots, descriptor set 0
  std::uint32_t push_constant_bytes = 0;  // size of the push constant block, 0 without one
  std::array<std::uint32_t, 3> local_size{1, 1, 1};
};

/// Throws device_error when the module uses another descriptor set, binding arrays or other resources.
KernelInterface reflect(std::span<const std::uint32_t> spirv, const std::string& name);

/// A compute kernel ready to be dispatched. Layout and work-group size come from the SPIR-V.
class ComputePipeline {
 public:
  ComputePipeline() = default;
  /// Specialisation constants that the module does not declare are ignored.
  ComputePipeline(const Device& device, std::string name, std::span<const std::uint32_t> spirv,
                  std::span<const SpecConstant> constants = {});
  ~ComputePipeline();
  ComputePipeline(ComputePipeline&& other) noexcept { swap(other); }
  ComputePipeline& operator=(ComputePipeline&& other) noexcept {
    ComputePipeline(std::move(other)).swap(*this);
    return *this;
  }

  explicit operator bool() const { return handle_ != nullptr; }
  const std::string& name() const { return name_; }
  const KernelInterface& interface() const { return interface_; }
  /// True when the kernel, as compiled, reads or writes this slot.
  bool uses(std::uint32_t slot) const;
  VkPipeline_T* handle() const { return handle_; }
  VkPipelineLayout_T* layout() const { return layout_; }

  /// Work-groups that cover width x height x depth invocations.
  std::array<std::uint32_t, 3> groups_for(int width, int height = 1, int depth = 1) const;

 private:
  void swap(ComputePipeline& other) noexcept;

  DeviceContext* context_ = nullptr;
  std::string name_;
  KernelInterface interface_;
  VkDescriptorSetLayout_T* set_layout_ = nullptr;
  VkPipelineLayout_T* layout_ = nullptr;
  VkPipeline_T* handle_ = nullptr;
};

/// compile() and ComputePipeline in one step; the pipeline is named after the kernel's main source.
ComputePipeline make_pipeline(const Device& device, const KernelDescription& kernel,
                              const CompileOptions& options = {});

}  // namespace brace::gpu
