#include <algorithm>
#include <cstring>
#include <functional>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"
#include "runtime/gpu/memory.hpp"

namespace brace::gpu {
namespace {

constexpr std::uint64_t staging_bytes_max = 16u << 20;

void ensure_transfer_commands(DeviceContext& context) {
  if (context.transfer_fence) return;
  const VolkDeviceTable& vk = context.vk;
  if (!context.transfer_pool) {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = context.queue_family;
    check_vk(vk.vkCreateCommandPool(context.device, &pool, nullptr, &context.transfer_pool), context,
             "create the transfer command pool");
  }
  if (!context.transfer_commands) {
    VkCommandBufferAllocateInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    buffer.commandPool = context.transfer_pool;
    buffer.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    buffer.commandBufferCount = 1;
    check_vk(vk.vkAllocateCommandBuffers(context.device, &buffer, &context.transfer_commands), context,
             "allocate the transfer commands");
  }
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check_vk(vk.vkCreateFence(context.device, &fence, nullptr, &context.transfer_fence), context,
           "create the transfer fence");
}

void ensure_staging(const Device& device, std::uint64_t bytes) {
  Buffer& staging = device.context().staging;
  if (!staging || staging.size_bytes() < bytes) {
    staging = Buffer();  // free before allocating the larger one
    staging = Buffer(device, "staging", bytes, Memory::readback);
  }
}

// Records with `record`, between full barriers, runs and waits.
void transfer(DeviceContext& context, const std::string& what,
              const std::function<void(VkCommandBuffer)>& record) {
  ensure_transfer_commands(context);
  const VolkDeviceTable& vk = context.vk;
  check_vk(vk.vkResetCommandPool(context.device, context.transfer_pool, 0), context, "reset " + what);
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check_vk(vk.vkBeginCommandBuffer(context.transfer_commands, &begin), context, "record " + what);
  record_full_barrier(context, context.transfer_commands);
  record(context.transfer_commands);
  record_full_barrier(context, context.transfer_commands);
  check_vk(vk.vkEndCommandBuffer(context.transfer_commands), context, "record " + what);
  submit_commands(context, context.transfer_commands, context.transfer_fence, what);
}

VkBufferImageCopy image_region(const Image& image, int first_slice, int first_row, int slices, int rows) {
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageOffset = {0, first_row, first_slice};
  region.imageExtent = {static_cast<std::uint32_t>(image.shape().width_px), static_cast<std::uint32_t>(rows),
                        static_cast<std::uint32_t>(slices)};
  return region;
}

// Splits slices [first, first + count) into blocks of whole slices, or of whole rows of one slice, that fit
// into the staging buffer; calls visit(region, offset of the block's first byte, its bytes).
void for_each_block(
    const Image& image, int first, int count,
    const std::function<void(const VkBufferImageCopy&, std::uint64_t, std::uint64_t)>& visit) {
  const ImageShape& shape = image.shape();
  const std::uint64_t row_bytes =
      static_cast<std::uint64_t>(shape.width_px) * bytes_per_texel(image.format());
  const std::uint64_t slice_bytes = row_bytes * static_cast<std::uint64_t>(shape.height_px);
  const auto rows_max = static_cast<int>(std::max<std::uint64_t>(1, staging_bytes_max / row_bytes));
  const auto slices_max = static_cast<int>(std::max<std::uint64_t>(1, staging_bytes_max / slice_bytes));
  std::uint64_t offset = 0;
  for (int slice = 0; slice < count; slice += slices_max) {
    const int slices = std::min(slices_max, count - slice);
    const int step = slices > 1 ? shape.height_px : rows_max;
    for (int row = 0; row < shape.height_px; row += step) {
      const int rows = std::min(step, shape.height_px - row);
      const std::uint64_t bytes =
          row_bytes * static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(slices);
      visit(image_region(image, first + slice, row, slices, rows), offset, bytes);
      offset += bytes;
    }
  }
}

}  // namespace

void record_full_barrier(const DeviceContext& context, VkCommandBuffer commands) {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT;
  memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT;
  memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  context.vk.vkCmdPipelineBarrier2(commands, &info);
}

void move_to_general_layout(DeviceContext& context, VkImage image, const std::string& name) {
  transfer(context, "layout of image '" + name + "'", [&](VkCommandBuffer commands) {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    context.vk.vkCmdPipelineBarrier2(commands, &info);
  });
}

void upload(const Device& device, const Buffer& to, std::span<const std::byte> bytes,
            std::uint64_t offset_bytes) {
  BRACE_CHECK(offset_bytes <= to.size_bytes() && bytes.size() <= to.size_bytes() - offset_bytes);
  if (bytes.empty()) return;
  if (to.is_mapped()) {
    std::memcpy(to.mapped().data() + offset_bytes, bytes.data(), bytes.size());
    return;
  }
  DeviceContext& context = device.context();
  ensure_staging(device, std::min<std::uint64_t>(staging_bytes_max, bytes.size()));
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t slab = std::min<std::uint64_t>(context.staging.size_bytes(), bytes.size() - done);
    std::memcpy(context.staging.mapped().data(), bytes.data() + done, slab);
    transfer(context, "upload to '" + to.name() + "'", [&](VkCommandBuffer commands) {
      const VkBufferCopy region{0, offset_bytes + done, slab};
      context.vk.vkCmdCopyBuffer(commands, context.staging.handle(), to.handle(), 1, &region);
    });
    done += slab;
  }
}

void download(const Device& device, const Buffer& from, std::span<std::byte> bytes,
              std::uint64_t offset_bytes) {
  BRACE_CHECK(offset_bytes <= from.size_bytes() && bytes.size() <= from.size_bytes() - offset_bytes);
  if (bytes.empty()) return;
  if (from.is_mapped()) {
    std::memcpy(bytes.data(), from.mapped().data() + offset_bytes, bytes.size());
    return;
  }
  DeviceContext& context = device.context();
  ensure_staging(device, std::min<std::uint64_t>(staging_bytes_max, bytes.size()));
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t slab = std::min<std::uint64_t>(context.staging.size_bytes(), bytes.size() - done);
    transfer(context, "download of '" + from.name() + "'", [&](VkCommandBuffer commands) {
      const VkBufferCopy region{offset_bytes + done, 0, slab};
      context.vk.vkCmdCopyBuffer(commands, from.handle(), context.staging.handle(), 1, &region);
    });
    std::memcpy(bytes.data() + done, context.staging.mapped().data(), slab);
    done += slab;
  }
}

void upload(const Device& device, const Image& to, std::span<const std::byte> texels, int first_slice) {
  const ImageShape& shape = to.shape();
  const std::uint64_t slice_bytes = static_cast<std::uint64_t>(shape.width_px) *
                                    static_cast<std::uint64_t>(shape.height_px) *
                                    bytes_per_texel(to.format());
  const auto slices = static_cast<int>(texels.size() / slice_bytes);
  BRACE_CHECK(texels.size() % slice_bytes == 0 && first_slice >= 0 && first_slice + slices <= shape.depth_px);
  DeviceContext& context = device.context();
  for_each_block(to, first_slice, slices,
                 [&](const VkBufferImageCopy& region, std::uint64_t offset, std::uint64_t bytes) {
                   ensure_staging(device, bytes);
                   std::memcpy(context.staging.mapped().data(), texels.data() + offset, bytes);
                   transfer(context, "upload to '" + to.name() + "'", [&](VkCommandBuffer commands) {
                     context.vk.vkCmdCopyBufferToImage(commands, context.staging.handle(), to.handle(),
                                                       VK_IMAGE_LAYOUT_GENERAL, 1, &region);
                   });
                 });
}

void download(const Device& device, const Image& from, std::span<std::byte> texels) {
  BRACE_CHECK(texels.size() == from.shape().texels() * bytes_per_texel(from.format()));
  DeviceContext& context = device.context();
  for_each_block(from, 0, from.shape().depth_px,
                 [&](const VkBufferImageCopy& region, std::uint64_t offset, std::uint64_t bytes) {
                   ensure_staging(device, bytes);
                   transfer(context, "download of '" + from.name() + "'", [&](VkCommandBuffer commands) {
                     context.vk.vkCmdCopyImageToBuffer(commands, from.handle(), VK_IMAGE_LAYOUT_GENERAL,
                                                       context.staging.handle(), 1, &region);
                   });
                   std::memcpy(texels.data() + offset, context.staging.mapped().data(), bytes);
                 });
}

}  // namespace brace::gpu
