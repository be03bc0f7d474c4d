#include "runtime/gpu/pipeline.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {
namespace {

void check_limits(const DeviceContext& context, const std::string& name, const KernelInterface& interface) {
  const DeviceLimits& limits = context.info.limits;
  if (interface.push_constant_bytes > limits.push_constant_bytes_max)
    throw device_error("kernel {} has {} bytes of push constants, but {} allows {}", name,
                       interface.push_constant_bytes, context.info.name, limits.push_constant_bytes_max);
  const auto [x, y, z] = interface.local_size;
  if (std::uint64_t{x} * y * z > limits.work_group_invocations_max)
    throw device_error("kernel {} has work-groups of {}x{}x{}, but {} allows {} invocations", name, x, y, z,
                       context.info.name, limits.work_group_invocations_max);
}

struct ShaderModule {
  const DeviceContext& context;
  VkShaderModule handle = nullptr;

  ShaderModule(const DeviceContext& device, std::span<const std::uint32_t> spirv, const std::string& name)
      : context(device) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    check_vk(context.vk.vkCreateShaderModule(context.device, &info, nullptr, &handle), context,
             "load kernel " + name);
    context.name_object(VK_OBJECT_TYPE_SHADER_MODULE, handle, name);
  }
  ShaderModule(const ShaderModule&) = delete;
  ShaderModule& operator=(const ShaderModule&) = delete;
  ~ShaderModule() { context.vk.vkDestroyShaderModule(context.device, handle, nullptr); }
};

VkDescriptorSetLayout create_set_layout(const DeviceContext& context, const KernelInterface& interface,
                                        const std::string& name) {
  std::vector<VkDescriptorSetLayoutBinding> slots;
  for (const KernelInterface::Binding& binding : interface.bindings) {
    VkDescriptorSetLayoutBinding slot{};
    slot.binding = binding.slot;
    slot.descriptorType = to_vk(binding.kind);
    slot.descriptorCount = 1;
    slot.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    slots.push_back(slot);
  }
  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  info.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  info.bindingCount = static_cast<std::uint32_t>(slots.size());
  info.pBindings = slots.data();
  VkDescriptorSetLayout layout = nullptr;
  check_vk(context.vk.vkCreateDescriptorSetLayout(context.device, &info, nullptr, &layout), context,
           "create the bindings of kernel " + name);
  return layout;
}

VkPipelineLayout create_pipeline_layout(const DeviceContext& context, VkDescriptorSetLayout set_layout,
                                        std::uint32_t push_constant_bytes, const std::string& name) {
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_constant_bytes};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = push_constant_bytes > 0 ? 1 : 0;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = nullptr;
  check_vk(context.vk.vkCreatePipelineLayout(context.device, &info, nullptr, &layout), context,
           "create the layout of kernel " + name);
  return layout;
}

VkPipeline create_pipeline(const DeviceContext& context, VkShaderModule module, VkPipelineLayout layout,
                           std::span<const SpecConstant> constants, const std::string& name) {
  std::vector<VkSpecializationMapEntry> entries;
  for (std::size_t i = 0; i < constants.size(); ++i)
    entries.push_back({constants[i].id,
                       static_cast<std::uint32_t>(i * sizeof(SpecConstant) + offsetof(SpecConstant, bits)),
                       sizeof(constants[i].bits)});
  const VkSpecializationInfo specialisation{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            constants.size_bytes(), constants.data()};
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialisation;
  info.layout = layout;
  VkPipeline pipeline = nullptr;
  check_vk(context.vk.vkCreateComputePipelines(context.device, nullptr, 1, &info, nullptr, &pipeline),
           context, "build kernel " + name);
  return pipeline;
}

}  // namespace

VkDescriptorType to_vk(BindingKind kind) {
  switch (kind) {
    case BindingKind::storage_buffer:
      return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case BindingKind::uniform_buffer:
      return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case BindingKind::uniform_texel_buffer:
      return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    case BindingKind::storage_texel_buffer:
      return VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
    case BindingKind::sampled_image:
      return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    case BindingKind::storage_image:
      return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
  }
  return VK_DESCRIPTOR_TYPE_MAX_ENUM;
}

ComputePipeline::ComputePipeline(const Device& device, std::string name, std::span<const std::uint32_t> spirv,
                                 std::span<const SpecConstant> constants)
    : ComputePipeline() {
  context_ = &device.context();
  name_ = std::move(name);
  interface_ = reflect(spirv, name_);
  check_limits(*context_, name_, interface_);
  const ShaderModule module(*context_, spirv, name_);
  set_layout_ = create_set_layout(*context_, interface_, name_);
  layout_ = create_pipeline_layout(*context_, set_layout_, interface_.push_constant_bytes, name_);
  handle_ = create_pipeline(*context_, module.handle, layout_, constants, name_);
  context_->name_object(VK_OBJECT_TYPE_PIPELINE, handle_, name_);
}

ComputePipeline::~ComputePipeline() {
  if (!context_) return;
  const VolkDeviceTable& vk = context_->vk;
  vk.vkDestroyPipeline(context_->device, handle_, nullptr);
  vk.vkDestroyPipelineLayout(context_->device, layout_, nullptr);
  vk.vkDestroyDescriptorSetLayout(context_->device, set_layout_, nullptr);
}

void ComputePipeline::swap(ComputePipeline& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(name_, other.name_);
  std::swap(interface_, other.interface_);
  std::swap(set_layout_, other.set_layout_);
  std::swap(layout_, other.layout_);
  std::swap(handle_, other.handle_);
}

bool ComputePipeline::uses(std::uint32_t slot) const {
  return std::any_of(interface_.bindings.begin(), interface_.bindings.end(),
                     [&](const auto& binding) { return binding.slot == slot; });
}

std::array<std::uint32_t, 3> ComputePipeline::groups_for(int width, int height, int depth) const {
  BRACE_CHECK(width >= 0 && height >= 0 && depth >= 0);
  const auto divide_up = [](int count, std::uint32_t size) {
    return (static_cast<std::uint32_t>(count) + size - 1) / size;
  };
  return {divide_up(width, interface_.local_size[0]), divide_up(height, interface_.local_size[1]),
          divide_up(depth, interface_.local_size[2])};
}

ComputePipeline make_pipeline(const Device& device, const KernelDescription& kernel,
                              const CompileOptions& options) {
  const CompiledKernel compiled = compile(kernel, options);
  return ComputePipeline(device, kernel.main.name, compiled.spirv, kernel.constants);
}

}  // namespace brace::gpu
