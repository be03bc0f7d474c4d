#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";
constexpr const char* how_to_get_a_driver =
    "install a driver: apt-get install libvulkan1 mesa-vulkan-drivers (software), or the GPU vendor's own; "
    "where a driver is installed, check VK_ICD_FILENAMES and VK_DRIVER_FILES";

VKAPI_ATTR VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                            VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
  static_cast<ValidationLog*>(log)->messages.emplace_back(data->pMessage ? data->pMessage : "");
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(ValidationLog* log) {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  // The loader's remarks (general) are about the machine. Performance messages ask for image layouts by use;
  // one general layout is a choice here: compute kernels gain nothing from others.
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  info.pfnUserCallback = keep_message;
  info.pUserData = log;
  return info;
}

bool has_extension(const char* name) {
  std::uint32_t count = 0;
  vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateInstanceExtensionProperties(nullptr, &count, extensions.data());
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

bool has_validation_layer() {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(),
                     [](const auto& l) { return std::strcmp(l.layerName, validation_layer) == 0; });
}

}  // namespace

Instance::Instance(ValidationLog* log, const std::vector<std::string>& extensions) {
  if (volkInitialize() != VK_SUCCESS)
    throw device_error("no Vulkan loader (libvulkan.so.1) on this machine; {}", how_to_get_a_driver);
  if (volkGetInstanceVersion() < VK_API_VERSION_1_3)
    throw device_error("the Vulkan loader is older than 1.3; {}", how_to_get_a_driver);
  if (log && !has_validation_layer())
    throw device_error(
        "validation was asked for, but {} is not installed: apt-get install vulkan-validationlayers",
        validation_layer);

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "brace";
  application.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  std::vector<const char*> enabled;
  for (const std::string& extension : extensions) {
    if (!has_extension(extension.c_str())) {
      throw device_error("the Vulkan loader has no {}, which the window needs; `brace run` needs no window",
                         extension);
    }
    enabled.push_back(extension.c_str());
  }
  has_debug_utils = has_extension(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  if (has_debug_utils) enabled.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  info.enabledExtensionCount = static_cast<std::uint32_t>(enabled.size());
  info.ppEnabledExtensionNames = enabled.data();
  VkDebugUtilsMessengerCreateInfoEXT messages = messenger_info(log);
  if (log) {
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
    if (has_debug_utils) info.pNext = &messages;
  }
  const VkResult result = vkCreateInstance(&info, nullptr, &handle);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
    throw device_error("no Vulkan driver on this machine; {}", how_to_get_a_driver);
  if (result != VK_SUCCESS)
    throw device_error("cannot create a Vulkan instance ({}); {}", result_text(result), how_to_get_a_driver);
  volkLoadInstanceOnly(handle);
  if (log && has_debug_utils) vkCreateDebugUtilsMessengerEXT(handle, &messages, nullptr, &messenger);
}

Instance::~Instance() {
  if (!handle) return;
  if (messenger) vkDestroyDebugUtilsMessengerEXT(handle, messenger, nullptr);
  vkDestroyInstance(handle, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const {
  std::uint32_t count = 0;
  VkResult result = vkEnumeratePhysicalDevices(handle, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  if (result == VK_SUCCESS && count > 0) result = vkEnumeratePhysicalDevices(handle, &count, devices.data());
  if (result != VK_SUCCESS && result != VK_INCOMPLETE)
    throw device_error("cannot list the Vulkan devices ({}); {}", result_text(result), how_to_get_a_driver);
  devices.resize(count);
  if (devices.empty()) throw device_error("no Vulkan device on this machine; {}", how_to_get_a_driver);
  return devices;
}

}  // namespace brace::gpu
