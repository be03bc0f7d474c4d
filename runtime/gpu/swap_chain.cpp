#include "runtime/gpu/swap_chain.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {

namespace {

void move_image(const DeviceContext& context, VkCommandBuffer commands, VkImage image, VkImageLayout from,
                VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  context.vk.vkCmdPipelineBarrier2(commands, &dependency);
}

/// As whole words, which compilers make vectors of: this is a good part of what a picture costs.
void copy_pixels(const ImageRgba8& picture, std::span<std::uint32_t> to, bool swap_red_and_blue) {
  static_assert(std::endian::native == std::endian::little);
  std::transform(picture.pixels.begin(), picture.pixels.end(), to.begin(), [=](const Rgba8& pixel) {
    const auto word = std::bit_cast<std::uint32_t>(pixel);
    return swap_red_and_blue ? (word & 0xff00ff00u) | (word & 0xffu) << 16 | (word >> 16 & 0xffu) : word;
  });
}

VkSurfaceFormatKHR choose_format(const DeviceContext& context, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceSurfaceFormatsKHR(context.physical, surface, &count, nullptr);
  std::vector<VkSurfaceFormatKHR> formats(count);
  vkGetPhysicalDeviceSurfaceFormatsKHR(context.physical, surface, &count, formats.data());
  for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM})
    for (const VkSurfaceFormatKHR& format : formats)
      if (format.format == wanted) return format;
  throw device_error("{}: the window takes no 8-bit pictures; `brace run` needs no window",
                     context.info.name);
}

}  // namespace

struct SwapChain::State {
  State(const Device& made_for, MakeSurface make_surface_of_window)
      : device(made_for), context(made_for.context()), make_of_window(std::move(make_surface_of_window)) {}
  ~State();

  void make(VkExtent2D extent, const VkSurfaceCapabilitiesKHR& capabilities);
  void drop_images();
  void drop_surface();
  /// Throws device_error when the window has no surface, or the device cannot show anything on it.
  void make_surface();
  /// False, and what the result is about dropped, when the window has changed; throws device_error for
  /// errors.
  bool still_there(VkResult result, const char* what);

  const Device& device;
  DeviceContext& context;
  MakeSurface make_of_window;
  VkSurfaceKHR surface = nullptr;
  VkSurfaceFormatKHR format{};
  VkSwapchainKHR chain = nullptr;
  VkExtent2D extent{};
  std::vector<VkImage> images;
  VkCommandPool pool = nullptr;
  VkCommandBuffer commands = nullptr;
  VkFence acquired = nullptr, done = nullptr;
  std::uint32_t loaded = 0;  // the image that load() has filled
  Buffer pixels;
};

SwapChain::State::~State() {
  if (context.device) context.vk.vkDeviceWaitIdle(context.device);
  drop_surface();
  context.vk.vkDestroyFence(context.device, acquired, nullptr);
  context.vk.vkDestroyFence(context.device, done, nullptr);
  context.vk.vkDestroyCommandPool(context.device, pool, nullptr);
}

void SwapChain::State::drop_images() {
  if (chain) context.vk.vkDestroySwapchainKHR(context.device, chain, nullptr);
  chain = nullptr;
  images.clear();
}

void SwapChain::State::drop_surface() {
  drop_images();
  if (surface) vkDestroySurfaceKHR(context.instance->handle, surface, nullptr);
  surface = nullptr;
}

void SwapChain::State::make_surface() {
  surface = make_of_window(context.instance->handle);
  if (!surface) throw device_error("the window has no Vulkan surface; `brace run` needs no window");
  VkBool32 presents = VK_FALSE;
  vkGetPhysicalDeviceSurfaceSupportKHR(context.physical, context.queue_family, surface, &presents);
  if (!presents) {
    throw device_error(
        "{} cannot show pictures in a window of this display; accepted: another device (--gpu), a virtual "
        "display of 24 bits (xvfb-run -s '-screen 0 1280x1024x24' brace live ..., from the package xvfb: "
        "Xvfb), "
        "or `brace run`, which needs no window",
        context.info.name);
  }
  format = choose_format(context, surface);
}

bool SwapChain::State::still_there(VkResult result, const char* what) {
  if (result == VK_ERROR_OUT_OF_DATE_KHR) {
    context.vk.vkDeviceWaitIdle(context.device);
    drop_images();
    return false;
  }
  if (result == VK_ERROR_SURFACE_LOST_KHR) {
    context.vk.vkDeviceWaitIdle(context.device);
    drop_surface();
    return false;
  }
  check_vk(result, context, what);
  return true;
}

void SwapChain::State::make(VkExtent2D new_extent, const VkSurfaceCapabilitiesKHR& capabilities) {
  context.vk.vkDeviceWaitIdle(context.device);
  drop_images();
  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface;
  info.minImageCount = capabilities.minImageCount + 1;
  if (capabilities.maxImageCount > 0)
    info.minImageCount = std::min(info.minImageCount, capabilities.maxImageCount);
  info.imageFormat = format.format;
  info.imageColorSpace = format.colorSpace;
  info.imageExtent = new_extent;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.preTransform = capabilities.currentTransform;
  info.compositeAlpha = capabilities.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  info.clipped = VK_TRUE;
  check_vk(context.vk.vkCreateSwapchainKHR(context.device, &info, nullptr, &chain), context,
           "create the window's swap-chain");
  std::uint32_t count = 0;
  context.vk.vkGetSwapchainImagesKHR(context.device, chain, &count, nullptr);
  images.resize(count);
  context.vk.vkGetSwapchainImagesKHR(context.device, chain, &count, images.data());
  extent = new_extent;
  pixels = Buffer();
  pixels = Buffer(device, "window pixels", std::uint64_t{extent.width} * extent.height * 4, Memory::upload);
}

SwapChain::SwapChain(const Device& device, const MakeSurface& make_surface)
    : state_(std::make_unique<State>(device, make_surface)) {
  State& state = *state_;
  DeviceContext& context = state.context;
  const VolkDeviceTable& vk = context.vk;
  BRACE_CHECK(vk.vkCreateSwapchainKHR != nullptr);
  state.make_surface();
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.queueFamilyIndex = context.queue_family;
  check_vk(vk.vkCreateCommandPool(context.device, &pool, nullptr, &state.pool), context,
           "create the window's command pool");
  VkCommandBufferAllocateInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  buffer.commandPool = state.pool;
  buffer.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  buffer.commandBufferCount = 1;
  check_vk(vk.vkAllocateCommandBuffers(context.device, &buffer, &state.commands), context,
           "allocate the window's commands");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  for (VkFence* made : {&state.acquired, &state.done})
    check_vk(vk.vkCreateFence(context.device, &fence, nullptr, made), context, "create the window's fence");
}

SwapChain::~SwapChain() = default;

SwapChain::Size SwapChain::fit(int window_width_px, int window_height_px) {
  State& state = *state_;
  if (!state.surface) state.make_surface();
  VkSurfaceCapabilitiesKHR capabilities{};
  if (!state.still_there(
          vkGetPhysicalDeviceSurfaceCapabilitiesKHR(state.context.physical, state.surface, &capabilities),
          "look at the window"))
    return {};
  VkExtent2D extent = capabilities.currentExtent;
  if (extent.width == 0xffffffffu) {  // the surface takes what it is given
    extent.width = std::clamp(static_cast<std::uint32_t>(std::max(window_width_px, 0)),
                              capabilities.minImageExtent.width, capabilities.maxImageExtent.width);
    extent.height = std::clamp(static_cast<std::uint32_t>(std::max(window_height_px, 0)),
                               capabilities.minImageExtent.height, capabilities.maxImageExtent.height);
  }
  if (extent.width == 0 || extent.height == 0) return {};
  if (!state.chain || extent.width != state.extent.width || extent.height != state.extent.height)
    state.make(extent, capabilities);
  return {static_cast<int>(extent.width), static_cast<int>(extent.height)};
}

bool SwapChain::load(const ImageRgba8& picture) {
  State& state = *state_;
  DeviceContext& context = state.context;
  const VolkDeviceTable& vk = context.vk;
  BRACE_CHECK(state.chain && picture.width_px == static_cast<int>(state.extent.width) &&
              picture.height_px == static_cast<int>(state.extent.height));
  copy_pixels(picture, state.pixels.mapped_as<std::uint32_t>(),
              state.format.format == VK_FORMAT_B8G8R8A8_UNORM);

  check_vk(vk.vkResetFences(context.device, 1, &state.acquired), context, "reset the window's fence");
  const VkResult acquired = vk.vkAcquireNextImageKHR(context.device, state.chain, UINT64_MAX, nullptr,
                                                     state.acquired, &state.loaded);
  if (!state.still_there(acquired, "take a picture of the window")) return false;
  check_vk(vk.vkWaitForFences(context.device, 1, &state.acquired, VK_TRUE, UINT64_MAX), context,
           "wait for a picture of the window");

  const VkImage image = state.images[state.loaded];
  check_vk(vk.vkResetCommandPool(context.device, state.pool, 0), context, "reset the window's commands");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check_vk(vk.vkBeginCommandBuffer(state.commands, &begin), context, "record the window's commands");
  move_image(context, state.commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {state.extent.width, state.extent.height, 1};
  vk.vkCmdCopyBufferToImage(state.commands, state.pixels.handle(), image,
                            VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
  move_image(context, state.commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
             VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
  check_vk(vk.vkEndCommandBuffer(state.commands), context, "record the window's commands");
  submit_commands(context, state.commands, state.done, "the window's picture");
  return true;
}

bool SwapChain::present() {
  State& state = *state_;
  DeviceContext& context = state.context;
  BRACE_CHECK(state.chain != nullptr);
  VkPresentInfoKHR present{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  present.swapchainCount = 1;
  present.pSwapchains = &state.chain;
  present.pImageIndices = &state.loaded;
  const VkResult shown = context.vk.vkQueuePresentKHR(context.queue, &present);
  if (shown != VK_SUBOPTIMAL_KHR) return state.still_there(shown, "show a picture in the window");
  context.vk.vkDeviceWaitIdle(context.device);
  state.drop_images();  // shown, but made for another size
  return true;
}

}  // namespace brace::gpu
