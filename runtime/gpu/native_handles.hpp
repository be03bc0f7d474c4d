#pragma once

#include <cstdint>

#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/device.hpp"

struct VkInstance_T;
struct VkPhysicalDevice_T;
struct VkDevice_T;

namespace brace::gpu {

/// What a native stage needs to work with Vulkan itself. Owned by the device.
struct NativeHandles {
  VkInstance_T* instance = nullptr;
  VkPhysicalDevice_T* physical_device = nullptr;
  VkDevice_T* device = nullptr;
  std::uint32_t queue_family_index = 0;
  std::uint32_t api_version = 0;
  void (*(*get_instance_proc_addr)(VkInstance_T*, const char*))(void) = nullptr;
};

NativeHandles native_handles(const Device& device);

}  // namespace brace::gpu
