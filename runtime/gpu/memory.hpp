#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "runtime/gpu/device.hpp"
#include "runtime/gpu/vulkan_handles.hpp"

namespace brace::gpu {

/// Where a buffer lives.
///   device:   fastest for kernels. Mapped as well where device memory is host-visible (integrated,
///   software). upload:   host-visible and coherent; the host writes, kernels read. readback: host-visible,
///   coherent, cached; kernels write, the host reads.
enum class Memory { device, upload, readback };

/// A range of bytes that kernels bind as storage, uniform or (through TexelBuffer) texel buffer.
/// Contents are undefined until written.
class Buffer {
 public:
  Buffer() = default;
  /// Throws device_error naming the buffer when it is larger than the device allows or memory is out.
  Buffer(const Device& device, std::string name, std::uint64_t size_bytes, Memory memory);
  ~Buffer();
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer(std::move(other)).swap(*this);
    return *this;
  }

  explicit operator bool() const { return handle_ != nullptr; }
  const std::string& name() const { return name_; }
  std::uint64_t size_bytes() const { return size_bytes_; }
  VkBuffer_T* handle() const { return handle_; }

  bool is_mapped() const { return mapped_ != nullptr; }
  /// The whole buffer as the host sees it; empty where it is not mapped. Valid as long as the buffer. Kernel
  /// results are visible after submit_and_wait of commands that end with a barrier to the host.
  std::span<std::byte> mapped() const { return {mapped_, mapped_ ? size_bytes_ : 0}; }
  template <typename T>
  std::span<T> mapped_as() const {
    static_assert(std::is_trivially_copyable_v<T>);
    return {reinterpret_cast<T*>(mapped_), mapped_ ? size_bytes_ / sizeof(T) : 0};
  }

 private:
  void swap(Buffer& other) noexcept;

  DeviceContext* context_ = nullptr;
  std::string name_;
  std::uint64_t size_bytes_ = 0;
  VkBuffer_T* handle_ = nullptr;
  VkDeviceMemory_T* memory_ = nullptr;
  std::byte* mapped_ = nullptr;
};

/// Texel formats that Brace uses. Lavapipe gathers 32-bit texels with AVX2 and all others element by element.
enum class Format {
  r8_unorm,
  r8_uint,
  r16_unorm,
  r16_uint,
  r32_uint,
  r32_float,
  rgba8_unorm,
  rg32_uint,
  rgba32_uint,
  rgba32_float
};

std::uint32_t bytes_per_texel(Format format);

/// A buffer, or a part of it, seen as an array of texels: usamplerBuffer / samplerBuffer (read, the fast path
/// of lavapipe) or imageBuffer / uimageBuffer (read and write) in GLSL. The buffer must outlive the view.
class TexelBuffer {
 public:
  TexelBuffer() = default;
  /// `size_bytes` 0: to the end. `offset_bytes` must be a multiple of
  /// limits().texel_buffer_offset_alignment_bytes. Throws device_error when the view has too many texels.
  TexelBuffer(const Device& device, const Buffer& buffer, Format format, std::uint64_t offset_bytes = 0,
              std::uint64_t size_bytes = 0);
  ~TexelBuffer();
  TexelBuffer(TexelBuffer&& other) noexcept { swap(other); }
  TexelBuffer& operator=(TexelBuffer&& other) noexcept {
    TexelBuffer(std::move(other)).swap(*this);
    return *this;
  }

  explicit operator bool() const { return handle_ != nullptr; }
  VkBufferView_T* handle() const { return handle_; }
  std::uint64_t texels() const { return texels_; }

 private:
  void swap(TexelBuffer& other) noexcept;

  DeviceContext* context_ = nullptr;
  VkBufferView_T* handle_ = nullptr;
  std::uint64_t texels_ = 0;
};

struct ImageShape {
  int width_px = 1;
  int height_px = 1;
  int depth_px = 1;  // 1: unused by a 2D image
  std::uint64_t texels() const {
    return static_cast<std::uint64_t>(width_px) * static_cast<std::uint64_t>(height_px) *
           static_cast<std::uint64_t>(depth_px);
  }
};

/// An image in the general layout, sampled or stored to. Use Image2D or Image3D. Contents start undefined.
class Image {
 public:
  Image() = default;
  ~Image();
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    Image(std::move(other)).swap(*this);
    return *this;
  }

  explicit operator bool() const { return handle_ != nullptr; }
  const std::string& name() const { return name_; }
  const ImageShape& shape() const { return shape_; }
  Format format() const { return format_; }
  VkImage_T* handle() const { return handle_; }
  VkImageView_T* view() const { return view_; }

 protected:
  /// `dimensions` 2 or 3. Throws device_error when an edge or the size is over the limits.
  Image(const Device& device, std::string name, ImageShape shape, Format format, int dimensions);

 private:
  void swap(Image& other) noexcept;

  DeviceContext* context_ = nullptr;
  std::string name_;
  ImageShape shape_;
  Format format_ = Format::r8_unorm;
  VkImage_T* handle_ = nullptr;
  VkDeviceMemory_T* memory_ = nullptr;
  VkImageView_T* view_ = nullptr;
};

class Image2D : public Image {
 public:
  Image2D() = default;
  Image2D(const Device& device, std::string name, int width_px, int height_px, Format format)
      : Image(device, std::move(name), {width_px, height_px, 1}, format, 2) {}
};

class Image3D : public Image {
 public:
  Image3D() = default;
  Image3D(const Device& device, std::string name, ImageShape shape, Format format)
      : Image(device, std::move(name), shape, format, 3) {}
};

enum class Filter { nearest, linear };
enum class Address { clamp_to_edge, clamp_to_zero, mirror };

class Sampler {
 public:
  Sampler() = default;
  Sampler(const Device& device, std::string name, Filter filter, Address address);
  ~Sampler();
  Sampler(Sampler&& other) noexcept { swap(other); }
  Sampler& operator=(Sampler&& other) noexcept {
    Sampler(std::move(other)).swap(*this);
    return *this;
  }

  explicit operator bool() const { return handle_ != nullptr; }
  VkSampler_T* handle() const { return handle_; }

 private:
  void swap(Sampler& other) noexcept;

  DeviceContext* context_ = nullptr;
  VkSampler_T* handle_ = nullptr;
};

// Blocking transfers. A mapped buffer is copied to directly, anything else goes in slabs through a staging
// buffer of at most 16 MiB that the device keeps.

void upload(const Device& device, const Buffer& to, std::span<const std::byte> bytes,
            std::uint64_t offset_bytes = 0);
void download(const Device& device, const Buffer& from, std::span<std::byte> bytes,
              std::uint64_t offset_bytes = 0);
/// `texels`: shape().texels() * bytes_per_texel(format()) bytes, x fastest, then y, then z. An image of part
/// of the slices, for input that is read in slabs: `first_slice` and a span of whole slices.
void upload(const Device& device, const Image& to, std::span<const std::byte> texels, int first_slice = 0);
void download(const Device& device, const Image& from, std::span<std::byte> texels);

template <typename T>
void upload_values(const Device& device, const Buffer& to, std::span<const T> values,
                   std::uint64_t offset_bytes = 0) {
  static_assert(std::is_trivially_copyable_v<T>);
  upload(device, to, std::as_bytes(values), offset_bytes);
}
template <typename T>
void download_values(const Device& device, const Buffer& from, std::span<T> values,
                     std::uint64_t offset_bytes = 0) {
  static_assert(std::is_trivially_copyable_v<T>);
  download(device, from, std::as_writable_bytes(values), offset_bytes);
}

}  // namespace brace::gpu
