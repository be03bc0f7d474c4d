#include <algorithm>
#include <cctype>
#include <cstring>

#include <fmt/core.h>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {
namespace {

struct Properties {
  VkPhysicalDeviceProperties2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceVulkan12Properties v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
};

struct Features {
  VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
};

DeviceType to_device_type(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return DeviceType::discrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return DeviceType::integrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceType::virtual_gpu;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return DeviceType::software;
    default:
      return DeviceType::other;
  }
}

bool has_device_extension(VkPhysicalDevice physical, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

std::string missing_of(VkPhysicalDevice physical, std::uint32_t api_version) {
  if (api_version < VK_API_VERSION_1_3) return "Vulkan 1.3";
  Features features;
  features.core.pNext = &features.v12;
  features.v12.pNext = &features.v13;
  vkGetPhysicalDeviceFeatures2(physical, &features.core);
  std::string missing;
  const auto need = [&](bool present, const char* what) {
    if (!present) missing += (missing.empty() ? "" : ", ") + std::string(what);
  };
  need(find_compute_family(physical) >= 0, "a compute queue");
  need(has_device_extension(physical, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME), "VK_KHR_push_descriptor");
  need(features.v13.synchronization2, "synchronization2");
  need(features.v12.scalarBlockLayout, "scalarBlockLayout");
  return missing;
}

void fill_limits(DeviceLimits& to, const Properties& from, VkPhysicalDevice physical) {
  const VkPhysicalDeviceLimits& limits = from.core.properties.limits;
  to.storage_buffer_bytes_max = limits.maxStorageBufferRange;
  to.allocation_bytes_max = from.v11.maxMemoryAllocationSize;
  to.texel_buffer_texels_max = limits.maxTexelBufferElements;
  to.texel_buffer_offset_alignment_bytes = limits.minTexelBufferOffsetAlignment;
  to.storage_buffer_offset_alignment_bytes = limits.minStorageBufferOffsetAlignment;
  to.uniform_buffer_bytes_max = limits.maxUniformBufferRange;
  to.push_constant_bytes_max = limits.maxPushConstantsSize;
  to.shared_memory_bytes_max = limits.maxComputeSharedMemorySize;
  to.work_group_invocations_max = limits.maxComputeWorkGroupInvocations;
  std::copy_n(limits.maxComputeWorkGroupCount, 3, to.work_group_count_max);
  to.image_2d_px_max = limits.maxImageDimension2D;
  to.image_3d_px_max = limits.maxImageDimension3D;
  to.subgroup_size = from.v11.subgroupSize;
  to.timestamp_period_ns = static_cast<double>(limits.timestampPeriod);
  to.is_software = from.core.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;

  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      to.memory_bytes = std::max<std::uint64_t>(to.memory_bytes, memory.memoryHeaps[i].size);

  Features features;
  features.core.pNext = &features.v12;
  vkGetPhysicalDeviceFeatures2(physical, &features.core);
  to.has_int8_storage = features.v12.storageBuffer8BitAccess && features.v12.shaderInt8;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string list_text(const std::vector<DeviceInfo>& devices) {
  std::string text;
  for (const DeviceInfo& device : devices)
    text += fmt::format("\n  {}: {} ({}, uuid {}){}", device.index, device.name, to_string(device.type),
                        device.uuid, device.missing.empty() ? "" : " lacks " + device.missing);
  return text;
}

std::size_t best_device(const std::vector<DeviceInfo>& devices) {
  // Software before `other`: an unknown kind of device is taken only when nothing else is there.
  const auto rank = [](const DeviceInfo& device) {
    switch (device.type) {
      case DeviceType::discrete:
        return 0;
      case DeviceType::integrated:
        return 1;
      case DeviceType::virtual_gpu:
        return 2;
      case DeviceType::software:
        return 3;
      case DeviceType::other:
        return 4;
    }
    return 5;
  };
  std::size_t best = devices.size();
  for (std::size_t i = 0; i < devices.size(); ++i)
    if (devices[i].missing.empty() && (best == devices.size() || rank(devices[i]) < rank(devices[best])))
      best = i;
  if (best == devices.size())
    throw device_error("no Vulkan device here can run Brace; found:{}", list_text(devices));
  return best;
}

bool matches(const DeviceInfo& device, const std::string& select) {
  if (select.find_first_not_of("0123456789") == std::string::npos && select.size() < 10)
    return device.index == static_cast<std::uint32_t>(std::stoul(select));
  std::string hex = lower(select);
  hex.erase(std::remove(hex.begin(), hex.end(), '-'), hex.end());
  return device.uuid == hex || lower(device.name).find(lower(select)) != std::string::npos;
}

}  // namespace

const char* to_string(DeviceType type) {
  switch (type) {
    case DeviceType::discrete:
      return "discrete";
    case DeviceType::integrated:
      return "integrated";
    case DeviceType::virtual_gpu:
      return "virtual";
    case DeviceType::software:
      return "software";
    case DeviceType::other:
      return "other";
  }
  return "other";
}

int find_compute_family(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  int fallback = -1;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
    if (families[i].timestampValidBits > 0) return static_cast<int>(i);
    if (fallback < 0) fallback = static_cast<int>(i);
  }
  return fallback;
}

DeviceInfo describe_device(VkPhysicalDevice physical, std::uint32_t index) {
  Properties properties;
  vkGetPhysicalDeviceProperties(physical, &properties.core.properties);
  const VkPhysicalDeviceProperties& core = properties.core.properties;
  DeviceInfo info;
  info.index = index;
  info.name = core.deviceName;
  info.type = to_device_type(core.deviceType);
  info.api_version = core.apiVersion;
  info.api_version_text =
      fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(core.apiVersion), VK_API_VERSION_MINOR(core.apiVersion),
                  VK_API_VERSION_PATCH(core.apiVersion));
  info.missing = missing_of(physical, core.apiVersion);
  if (core.apiVersion < VK_API_VERSION_1_3) return info;

  properties.core.pNext = &properties.v11;
  properties.v11.pNext = &properties.v12;
  vkGetPhysicalDeviceProperties2(physical, &properties.core);
  info.driver = fmt::format("{} {}", properties.v12.driverName, properties.v12.driverInfo);
  for (const std::uint8_t byte : properties.v11.deviceUUID)
    info.uuid += fmt::format("{:02x}", byte);
  fill_limits(info.limits, properties, physical);
  return info;
}

std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select) {
  if (select.empty()) return best_device(devices);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < devices.size(); ++i)
    if (matches(devices[i], select)) found.push_back(i);
  if (found.size() != 1)
    throw input_error("--gpu '{}' names {}; accepted: an index, a UUID or a part of one name of:{}", select,
                      found.empty() ? "no Vulkan device" : "several Vulkan devices", list_text(devices));
  const DeviceInfo& device = devices[found.front()];
  if (!device.missing.empty())
    throw device_error("--gpu '{}': {} lacks {}, which Brace needs", select, device.name, device.missing);
  return found.front();
}

std::vector<DeviceInfo> list_devices() {
  const Instance instance(nullptr);
  std::vector<DeviceInfo> devices;
  for (const VkPhysicalDevice physical : instance.physical_devices())
    devices.push_back(describe_device(physical, static_cast<std::uint32_t>(devices.size())));
  return devices;
}

}  // namespace brace::gpu
