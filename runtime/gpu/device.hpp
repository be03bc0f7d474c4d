#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace brace::gpu {

/// The driver has reset or removed the device: nothing made from it works any more. Exit code 3.
class DeviceLost : public Error {
 public:
  explicit DeviceLost(const std::string& message) : Error(ExitCode::device_or_plugin_failed, message) {}
};

enum class DeviceType { discrete, integrated, virtual_gpu, software, other };

const char* to_string(DeviceType type);

/// What kernels and allocations have to keep within. Lavapipe (Mesa 22.3): storage buffer range 128 MiB, one
/// allocation 2 GiB, 128 Mi texels per texel buffer, push constants 128 bytes, subgroups of 8.
struct DeviceLimits {
  std::uint64_t storage_buffer_bytes_max = 0;  // one binding
  std::uint64_t allocation_bytes_max = 0;      // one Buffer or Image
  std::uint64_t texel_buffer_texels_max = 0;   // one TexelBuffer
  std::uint64_t texel_buffer_offset_alignment_bytes = 0;
  std::uint64_t storage_buffer_offset_alignment_bytes = 0;
  std::uint64_t memory_bytes = 0;  // largest device-local heap
  std::uint32_t uniform_buffer_bytes_max = 0;
  std::uint32_t push_constant_bytes_max = 0;
  std::uint32_t shared_memory_bytes_max = 0;
  std::uint32_t work_group_invocations_max = 0;
  std::uint32_t work_group_count_max[3] = {};
  std::uint32_t image_2d_px_max = 0;
  std::uint32_t image_3d_px_max = 0;
  std::uint32_t subgroup_size = 0;
  double timestamp_period_ns = 0.0;  // 0: the device has no timestamps
  bool is_software = false;
  bool has_int8_storage = false;  // uint8_t in storage buffers (GL_EXT_shader_8bit_storage)
};

struct DeviceInfo {
  std::uint32_t index = 0;  // in the loader's order
  std::string name;
  std::string driver;  // driver name and version as it reports them
  std::string uuid;    // 32 hexadecimal digits
  DeviceType type = DeviceType::other;
  std::uint32_t api_version = 0;  // as VK_MAKE_API_VERSION
  std::string api_version_text;   // "1.3.230"
  std::string missing;            // what Brace needs and the device lacks, comma separated; "" if usable
  DeviceLimits limits;
};

struct DeviceOptions {
  /// The value of --gpu: an index, a UUID (32 hex digits, dashes ignored) or a part of the name, any case.
  /// "" chooses discrete before integrated before software.
  std::string select;
  /// Validation layers; also switched on by the environment variable BRACE_VALIDATION=1.
  bool validation = false;
  /// Treat memory as not host-visible even where it is, so that the staging path runs (tests).
  bool force_staging = false;
  /// Instance extensions that a window system asks for: the device can then have a SwapChain.
  std::vector<std::string> window_extensions = {};
};

/// All devices of the loader, usable or not. Throws device_error when there is no loader or no driver, naming
/// the Debian packages to install.
std::vector<DeviceInfo> list_devices();

struct DeviceContext;  // device_context.hpp, inside runtime/gpu only

/// A logical device with one compute queue. Must outlive everything made from it. One thread at a time.
class Device {
 public:
  /// Throws input_error when `select` names no device or several, device_error when none is usable.
  explicit Device(const DeviceOptions& options = {});
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  const DeviceInfo& info() const;
  const DeviceLimits& limits() const;

  bool validation_enabled() const;
  /// Messages of the validation layers (warnings and errors) since the device was made, in order.
  const std::vector<std::string>& validation_messages() const;

  DeviceContext& context() const { return *context_; }

 private:
  std::unique_ptr<DeviceContext> context_;
};

}  // namespace brace::gpu
