#include "runtime/gpu/native_handles.hpp"

#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {

NativeHandles native_handles(const Device& device) {
  const DeviceContext& context = device.context();
  NativeHandles handles;
  handles.instance = context.instance->handle;
  handles.physical_device = context.physical;
  handles.device = context.device;
  handles.queue_family_index = context.queue_family;
  handles.api_version = context.info.api_version;
  handles.get_instance_proc_addr = vkGetInstanceProcAddr;
  return handles;
}

}  // namespace brace::gpu
