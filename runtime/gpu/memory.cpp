#include "runtime/gpu/memory.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {
namespace {

// Preferred memory properties first; the last entry of each list is guaranteed by Vulkan.
std::vector<VkMemoryPropertyFlags> wanted_properties(Memory memory, bool prefer_mapped) {
  constexpr VkMemoryPropertyFlags local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  constexpr VkMemoryPropertyFlags host =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  constexpr VkMemoryPropertyFlags cached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  switch (memory) {
    case Memory::device:
      if (prefer_mapped) return {local | host | cached, local, 0};
      return {local, 0};
    case Memory::upload:
      return {host};
    case Memory::readback:
      return {host | cached, host};
  }
  return {0};
}

int find_memory_type(const VkPhysicalDeviceMemoryProperties& properties, std::uint32_t type_bits,
                     VkMemoryPropertyFlags wanted) {
  for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i)
    if ((type_bits & (1u << i)) && (properties.memoryTypes[i].propertyFlags & wanted) == wanted)
      return static_cast<int>(i);
  return -1;
}

struct Allocation {
  VkDeviceMemory memory = nullptr;
  bool host_visible = false;
};

Allocation allocate(const DeviceContext& context, const VkMemoryRequirements& needs, Memory memory,
                    const std::string& name) {
  if (needs.size > context.info.limits.allocation_bytes_max)
    throw device_error("{}: '{}' needs {} bytes, but one allocation may have at most {}", context.info.name,
                       name, needs.size, context.info.limits.allocation_bytes_max);
  // Only where host and device share memory does mapping cost nothing.
  const bool shared =
      context.info.type == DeviceType::integrated || context.info.type == DeviceType::software;
  for (const VkMemoryPropertyFlags wanted : wanted_properties(memory, shared && !context.force_staging)) {
    const int type = find_memory_type(context.memory_properties, needs.memoryTypeBits, wanted);
    if (type < 0) continue;
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.allocationSize = needs.size;
    info.memoryTypeIndex = static_cast<std::uint32_t>(type);
    Allocation allocation;
    check_vk(context.vk.vkAllocateMemory(context.device, &info, nullptr, &allocation.memory), context,
             fmt::format("allocate {} bytes for '{}'", needs.size, name));
    const VkMemoryPropertyFlags got = context.memory_properties.memoryTypes[type].propertyFlags;
    allocation.host_visible = (got & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) &&
                              (got & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) &&
                              (memory != Memory::device || (shared && !context.force_staging));
    context.name_object(VK_OBJECT_TYPE_DEVICE_MEMORY, allocation.memory, name);
    return allocation;
  }
  throw device_error("{}: no memory type for '{}'", context.info.name, name);
}

bool can_store(const DeviceContext& context, VkFormat format) {
  VkFormatProperties properties{};
  vkGetPhysicalDeviceFormatProperties(context.physical, format, &properties);
  return (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT) != 0;
}

}  // namespace

// Delegating to the default constructor makes the object whole, so the destructor cleans up when the body
// throws. The other resources do the same.
Buffer::Buffer(const Device& device, std::string name, std::uint64_t size_bytes, Memory memory) : Buffer() {
  BRACE_CHECK(size_bytes > 0);
  context_ = &device.context();
  name_ = std::move(name);
  size_bytes_ = size_bytes;
  if (size_bytes > context_->info.limits.allocation_bytes_max)
    throw device_error("{}: buffer '{}' of {} bytes is larger than the {} bytes that one allocation may have",
                       context_->info.name, name_, size_bytes, context_->info.limits.allocation_bytes_max);
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = size_bytes;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
               VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const VolkDeviceTable& vk = context_->vk;
  check_vk(vk.vkCreateBuffer(context_->device, &info, nullptr, &handle_), *context_,
           "create buffer '" + name_ + "'");
  context_->name_object(VK_OBJECT_TYPE_BUFFER, handle_, name_);
  VkMemoryRequirements needs{};
  vk.vkGetBufferMemoryRequirements(context_->device, handle_, &needs);
  const Allocation allocation = allocate(*context_, needs, memory, name_);
  memory_ = allocation.memory;
  check_vk(vk.vkBindBufferMemory(context_->device, handle_, memory_, 0), *context_, "bind '" + name_ + "'");
  if (!allocation.host_visible) return;
  void* mapped = nullptr;
  check_vk(vk.vkMapMemory(context_->device, memory_, 0, VK_WHOLE_SIZE, 0, &mapped), *context_,
           "map '" + name_ + "'");
  mapped_ = static_cast<std::byte*>(mapped);
}

Buffer::~Buffer() {
  if (!context_) return;
  context_->vk.vkDestroyBuffer(context_->device, handle_, nullptr);
  context_->vk.vkFreeMemory(context_->device, memory_, nullptr);
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(name_, other.name_);
  std::swap(size_bytes_, other.size_bytes_);
  std::swap(handle_, other.handle_);
  std::swap(memory_, other.memory_);
  std::swap(mapped_, other.mapped_);
}

std::uint32_t bytes_per_texel(Format format) {
  switch (format) {
    case Format::r8_unorm:
    case Format::r8_uint:
      return 1;
    case Format::r16_unorm:
    case Format::r16_uint:
      return 2;
    case Format::r32_uint:
    case Format::r32_float:
    case Format::rgba8_unorm:
      return 4;
    case Format::rg32_uint:
      return 8;
    case Format::rgba32_uint:
    case Format::rgba32_float:
      return 16;
  }
  return 0;
}

VkFormat to_vk(Format format) {
  switch (format) {
    case Format::r8_unorm:
      return VK_FORMAT_R8_UNORM;
    case Format::r8_uint:
      return VK_FORMAT_R8_UINT;
    case Format::r16_unorm:
      return VK_FORMAT_R16_UNORM;
    case Format::r16_uint:
      return VK_FORMAT_R16_UINT;
    case Format::r32_uint:
      return VK_FORMAT_R32_UINT;
    case Format::r32_float:
      return VK_FORMAT_R32_SFLOAT;
    case Format::rgba8_unorm:
      return VK_FORMAT_R8G8B8A8_UNORM;
    case Format::rg32_uint:
      return VK_FORMAT_R32G32_UINT;
    case Format::rgba32_uint:
      return VK_FORMAT_R32G32B32A32_UINT;
    case Format::rgba32_float:
      return VK_FORMAT_R32G32B32A32_SFLOAT;
  }
  return VK_FORMAT_UNDEFINED;
}

TexelBuffer::TexelBuffer(const Device& device, const Buffer& buffer, Format format,
                         std::uint64_t offset_bytes, std::uint64_t size_bytes)
    : TexelBuffer() {
  BRACE_CHECK(buffer && offset_bytes < buffer.size_bytes());
  context_ = &device.context();
  const DeviceLimits& limits = context_->info.limits;
  BRACE_CHECK(offset_bytes % limits.texel_buffer_offset_alignment_bytes == 0);
  const std::uint64_t bytes = size_bytes ? size_bytes : buffer.size_bytes() - offset_bytes;
  BRACE_CHECK(bytes <= buffer.size_bytes() - offset_bytes);
  texels_ = bytes / bytes_per_texel(format);
  if (texels_ > limits.texel_buffer_texels_max)
    throw device_error("{}: a view of buffer '{}' has {} texels, but at most {} are possible",
                       context_->info.name, buffer.name(), texels_, limits.texel_buffer_texels_max);
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = buffer.handle();
  info.format = to_vk(format);
  info.offset = offset_bytes;
  info.range = texels_ * bytes_per_texel(format);
  check_vk(context_->vk.vkCreateBufferView(context_->device, &info, nullptr, &handle_), *context_,
           "create a texel view of '" + buffer.name() + "'");
  context_->name_object(VK_OBJECT_TYPE_BUFFER_VIEW, handle_, buffer.name() + " texels");
}

TexelBuffer::~TexelBuffer() {
  if (context_) context_->vk.vkDestroyBufferView(context_->device, handle_, nullptr);
}

void TexelBuffer::swap(TexelBuffer& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(handle_, other.handle_);
  std::swap(texels_, other.texels_);
}

Image::Image(const Device& device, std::string name, ImageShape shape, Format format, int dimensions)
    : Image() {
  context_ = &device.context();
  name_ = std::move(name);
  shape_ = shape;
  format_ = format;
  BRACE_CHECK(shape.width_px > 0 && shape.height_px > 0 && shape.depth_px > 0);
  const DeviceLimits& limits = context_->info.limits;
  const std::uint32_t edge_max = dimensions == 3 ? limits.image_3d_px_max : limits.image_2d_px_max;
  const int edge = std::max({shape.width_px, shape.height_px, shape.depth_px});
  if (static_cast<std::uint32_t>(edge) > edge_max)
    throw device_error("{}: image '{}' has an edge of {} pixels, but at most {} are possible",
                       context_->info.name, name_, edge, edge_max);
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = dimensions == 3 ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D;
  info.format = to_vk(format);
  info.extent = {static_cast<std::uint32_t>(shape.width_px), static_cast<std::uint32_t>(shape.height_px),
                 static_cast<std::uint32_t>(shape.depth_px)};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  if (can_store(*context_, info.format)) info.usage |= VK_IMAGE_USAGE_STORAGE_BIT;
  const VolkDeviceTable& vk = context_->vk;
  check_vk(vk.vkCreateImage(context_->device, &info, nullptr, &handle_), *context_,
           "create image '" + name_ + "'");
  context_->name_object(VK_OBJECT_TYPE_IMAGE, handle_, name_);
  VkMemoryRequirements needs{};
  vk.vkGetImageMemoryRequirements(context_->device, handle_, &needs);
  memory_ = allocate(*context_, needs, Memory::device, name_).memory;
  check_vk(vk.vkBindImageMemory(context_->device, handle_, memory_, 0), *context_, "bind '" + name_ + "'");
  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = handle_;
  view.viewType = dimensions == 3 ? VK_IMAGE_VIEW_TYPE_3D : VK_IMAGE_VIEW_TYPE_2D;
  view.format = info.format;
  view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  check_vk(vk.vkCreateImageView(context_->device, &view, nullptr, &view_), *context_,
           "create the view of image '" + name_ + "'");
  context_->name_object(VK_OBJECT_TYPE_IMAGE_VIEW, view_, name_);
  move_to_general_layout(*context_, handle_, name_);
}

Image::~Image() {
  if (!context_) return;
  context_->vk.vkDestroyImageView(context_->device, view_, nullptr);
  context_->vk.vkDestroyImage(context_->device, handle_, nullptr);
  context_->vk.vkFreeMemory(context_->device, memory_, nullptr);
}

void Image::swap(Image& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(name_, other.name_);
  std::swap(shape_, other.shape_);
  std::swap(format_, other.format_);
  std::swap(handle_, other.handle_);
  std::swap(memory_, other.memory_);
  std::swap(view_, other.view_);
}

namespace {

VkSamplerAddressMode address_mode(Address address) {
  switch (address) {
    case Address::clamp_to_edge:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    case Address::clamp_to_zero:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER;
    case Address::mirror:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
  }
  return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
}

}  // namespace

Sampler::Sampler(const Device& device, std::string name, Filter filter, Address address) : Sampler() {
  context_ = &device.context();
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = filter == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW = address_mode(address);
  info.borderColor = VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK;
  check_vk(context_->vk.vkCreateSampler(context_->device, &info, nullptr, &handle_), *context_,
           "create sampler '" + name + "'");
  context_->name_object(VK_OBJECT_TYPE_SAMPLER, handle_, name);
}

Sampler::~Sampler() {
  if (context_) context_->vk.vkDestroySampler(context_->device, handle_, nullptr);
}

void Sampler::swap(Sampler& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(handle_, other.handle_);
}

}  // namespace brace::gpu
