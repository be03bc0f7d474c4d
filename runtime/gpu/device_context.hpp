#pragma once

#include <memory>
#include <string>
#include <vector>

#include <volk.h>

#include "runtime/gpu/device.hpp"
#include "runtime/gpu/memory.hpp"
#include "runtime/gpu/pipeline.hpp"

namespace brace::gpu {

// Shared by the .cpp files of runtime/gpu; no other folder includes this.

struct ValidationLog {
  bool enabled = false;
  std::vector<std::string> messages;
};

/// An instance with, if asked for, validation layers that write to `log` (which must outlive it).
struct Instance {
  VkInstance handle = nullptr;
  VkDebugUtilsMessengerEXT messenger = nullptr;
  bool has_debug_utils = false;

  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  /// `log` null: no validation. Throws device_error without a loader, or without one of the extensions.
  explicit Instance(ValidationLog* log, const std::vector<std::string>& extensions = {});
  ~Instance();

  std::vector<VkPhysicalDevice> physical_devices() const;
};

/// What a Device owns.
struct DeviceContext {
  std::unique_ptr<ValidationLog> log;
  std::unique_ptr<Instance> instance;
  DeviceInfo info;
  bool force_staging = false;
  VkPhysicalDevice physical = nullptr;
  VkDevice device = nullptr;
  VkQueue queue = nullptr;
  std::uint32_t queue_family = 0;
  VkPhysicalDeviceMemoryProperties memory_properties{};
  VolkDeviceTable vk{};  // this device's own entry points: several devices live side by side

  // For uploads and downloads, made on first use.
  Buffer staging;
  VkCommandPool transfer_pool = nullptr;
  VkCommandBuffer transfer_commands = nullptr;
  VkFence transfer_fence = nullptr;

  DeviceContext() = default;
  DeviceContext(const DeviceContext&) = delete;
  DeviceContext& operator=(const DeviceContext&) = delete;
  ~DeviceContext();

  void name_object(VkObjectType type, const void* handle, const std::string& name) const;
};

/// Properties of a physical device in Brace's words; fills `missing`.
DeviceInfo describe_device(VkPhysicalDevice physical, std::uint32_t index);

/// The family to run compute on: a compute family with timestamps; -1 without one.
int find_compute_family(VkPhysicalDevice physical);

/// Index into the devices of what `select` means. Throws input_error or device_error.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select);

/// Throws device_error when `result` is an error; `what` says what was tried ("create buffer volume").
void check_vk(VkResult result, const DeviceContext& context, const std::string& what);
std::string result_text(VkResult result);

/// Submits one command buffer and waits for it.
void submit_commands(DeviceContext& context, VkCommandBuffer commands, VkFence fence,
                     const std::string& what);

/// Puts a new image into the general layout, in which it stays; blocking.
void move_to_general_layout(DeviceContext& context, VkImage image, const std::string& name);

/// A barrier between any two commands and the host.
void record_full_barrier(const DeviceContext& context, VkCommandBuffer commands);

VkFormat to_vk(Format format);
VkDescriptorType to_vk(BindingKind kind);

}  // namespace brace::gpu
