#include "runtime/gpu/device.hpp"

#include <cstdlib>
#include <string_view>

#include <fmt/core.h>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {
namespace {

bool validation_asked_for(const DeviceOptions& options) {
  const char* value = std::getenv("BRACE_VALIDATION");
  return options.validation || (value && std::string_view(value) == "1");
}

void create_logical_device(DeviceContext& context, bool presents) {
  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = context.queue_family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;

  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  v13.synchronization2 = VK_TRUE;
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  v12.pNext = &v13;
  v12.scalarBlockLayout = VK_TRUE;
  v12.storageBuffer8BitAccess = v12.shaderInt8 = context.info.limits.has_int8_storage ? VK_TRUE : VK_FALSE;

  std::vector<const char*> extensions = {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  if (presents) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.pNext = &v12;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check_vk(vkCreateDevice(context.physical, &info, nullptr, &context.device), context, "create the device");
  volkLoadDeviceTable(&context.vk, context.device);
  context.vk.vkGetDeviceQueue(context.device, context.queue_family, 0, &context.queue);
  context.name_object(VK_OBJECT_TYPE_QUEUE, context.queue, "compute queue");
}

}  // namespace

Device::Device(const DeviceOptions& options) : context_(std::make_unique<DeviceContext>()) {
  DeviceContext& context = *context_;
  context.log = std::make_unique<ValidationLog>();
  context.log->enabled = validation_asked_for(options);
  context.instance = std::make_unique<Instance>(context.log->enabled ? context.log.get() : nullptr,
                                                options.window_extensions);
  context.force_staging = options.force_staging;

  const std::vector<VkPhysicalDevice> physical = context.instance->physical_devices();
  std::vector<DeviceInfo> infos;
  for (const VkPhysicalDevice device : physical)
    infos.push_back(describe_device(device, static_cast<std::uint32_t>(infos.size())));
  const std::size_t chosen = choose_device(infos, options.select);
  context.physical = physical[chosen];
  context.info = infos[chosen];
  context.queue_family = static_cast<std::uint32_t>(find_compute_family(context.physical));
  vkGetPhysicalDeviceMemoryProperties(context.physical, &context.memory_properties);
  create_logical_device(context, !options.window_extensions.empty());
}

Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

const DeviceInfo& Device::info() const {
  return context_->info;
}
const DeviceLimits& Device::limits() const {
  return context_->info.limits;
}
bool Device::validation_enabled() const {
  return context_->log->enabled;
}
const std::vector<std::string>& Device::validation_messages() const {
  return context_->log->messages;
}

DeviceContext::~DeviceContext() {
  if (!device) return;
  vk.vkDeviceWaitIdle(device);
  staging = Buffer();
  vk.vkDestroyFence(device, transfer_fence, nullptr);
  vk.vkDestroyCommandPool(device, transfer_pool, nullptr);
  vk.vkDestroyDevice(device, nullptr);
}

void DeviceContext::name_object(VkObjectType type, const void* handle, const std::string& name) const {
  if (!instance->has_debug_utils || !vkSetDebugUtilsObjectNameEXT) return;
  VkDebugUtilsObjectNameInfoEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  label.objectType = type;
  label.objectHandle = reinterpret_cast<std::uint64_t>(handle);
  label.pObjectName = name.c_str();
  vkSetDebugUtilsObjectNameEXT(device, &label);
}

std::string result_text(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_DEVICE_LOST:
      return "device lost";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialisation failed";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "incompatible driver";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "feature not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "extension not present";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "too many objects";
    default:
      return fmt::format("VkResult {}", static_cast<int>(result));
  }
}

void check_vk(VkResult result, const DeviceContext& context, const std::string& what) {
  if (result >= 0) return;
  if (result == VK_ERROR_DEVICE_LOST)
    throw DeviceLost(fmt::format("{}: device lost while trying to {}; the driver has reset or removed it",
                                 context.info.name, what));
  throw device_error("{}: cannot {}: {}", context.info.name, what, result_text(result));
}

void submit_commands(DeviceContext& context, VkCommandBuffer commands, VkFence fence,
                     const std::string& what) {
  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer;
  check_vk(context.vk.vkResetFences(context.device, 1, &fence), context, "reset the fence of " + what);
  check_vk(context.vk.vkQueueSubmit2(context.queue, 1, &submit, fence), context, "submit " + what);
  check_vk(context.vk.vkWaitForFences(context.device, 1, &fence, VK_TRUE, UINT64_MAX), context,
           "wait for " + what);
}

}  // namespace brace::gpu
