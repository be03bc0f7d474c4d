// A window's swap-chain when the driver says that window or surface are not what they were. Results of the
// driver are put in by hand: few systems lose a surface when asked to.
#include "runtime/gpu/swap_chain.hpp"

#include <csignal>
#include <cstdio>
#include <map>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "runtime/gpu/device_context.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"
// After Vulkan's own types, so that GLFW declares its functions for them.
#include <GLFW/glfw3.h>

namespace brace::gpu {
namespace {

using ::testing::HasSubstr;

/// An X server of this program's own.
class VirtualDisplay {
 public:
  VirtualDisplay() {
    int ends[2] = {-1, -1};
    if (::pipe(ends) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      const int silent = ::open("/dev/null", O_WRONLY);
      ::dup2(silent, 2);
      ::close(ends[0]);
      const std::string write_end = std::to_string(ends[1]);
      ::execlp("Xvfb", "Xvfb", "-displayfd", write_end.c_str(), "-screen", "0", "640x480x24", nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    char digit = 0;
    while (::read(ends[0], &digit, 1) == 1 && digit != '\n')
      number_ += digit;
    ::close(ends[0]);
  }
  ~VirtualDisplay() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  std::string name() const { return number_.empty() ? "" : ":" + number_; }

 private:
  pid_t process_ = -1;
  std::string number_;
};

// What the driver is made to say, once each.
VkResult of_acquire = VK_SUCCESS, of_present = VK_SUCCESS, of_capabilities = VK_SUCCESS;
PFN_vkAcquireNextImageKHR real_acquire = nullptr;
PFN_vkQueuePresentKHR real_present = nullptr;
PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR real_capabilities = nullptr;

VkResult once(VkResult& result) {
  return std::exchange(result, VK_SUCCESS);
}

VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice device, VkSwapchainKHR chain, std::uint64_t timeout_ns,
                                       VkSemaphore semaphore, VkFence fence, std::uint32_t* index) {
  const VkResult said = once(of_acquire);
  return said != VK_SUCCESS ? said : real_acquire(device, chain, timeout_ns, semaphore, fence, index);
}
VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR* info) {
  const VkResult said = once(of_present);
  if (said < 0) return said;
  const VkResult shown = real_present(queue, info);
  return said != VK_SUCCESS ? said : shown;
}
VKAPI_ATTR VkResult VKAPI_CALL capabilities(VkPhysicalDevice device, VkSurfaceKHR surface,
                                            VkSurfaceCapabilitiesKHR* found) {
  const VkResult said = once(of_capabilities);
  return said != VK_SUCCESS ? said : real_capabilities(device, surface, found);
}

class SwapChainFaults : public GpuTest {
 protected:
  static void SetUpTestSuite() {
    display_ = std::make_unique<VirtualDisplay>();
    if (display_->name().empty()) return;
    ::setenv("DISPLAY", display_->name().c_str(), 1);
    if (glfwInit() != GLFW_TRUE) return;
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_TRUE);
    window_ = glfwCreateWindow(width_px, height_px, "swap-chain", nullptr, nullptr);
    if (window_ == nullptr) return;
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    std::string reason;
    device_ =
        open({.select = {}, .window_extensions = std::vector<std::string>(names, names + count)}, reason);
  }
  static void TearDownTestSuite() {
    device_.reset();
    if (window_ != nullptr) glfwDestroyWindow(window_);
    glfwTerminate();
    display_.reset();
  }
  void SetUp() override {
    if (!device_) GTEST_SKIP() << "no Xvfb, or no Vulkan device that shows pictures on it";
    DeviceContext& context = device_->context();
    real_acquire = std::exchange(context.vk.vkAcquireNextImageKHR, acquire);
    real_present = std::exchange(context.vk.vkQueuePresentKHR, present);
    real_capabilities = std::exchange(vkGetPhysicalDeviceSurfaceCapabilitiesKHR, capabilities);
    surfaces_ = 0;
    chain_ = std::make_unique<SwapChain>(*device_, [this](VkInstance instance) {
      ++surfaces_;
      VkSurfaceKHR surface = nullptr;
      return has_window_ && glfwCreateWindowSurface(instance, window_, nullptr, &surface) == VK_SUCCESS
                 ? surface
                 : VkSurfaceKHR{};
    });
  }
  void TearDown() override {
    if (!device_) return;
    chain_.reset();
    of_acquire = of_present = of_capabilities = VK_SUCCESS;
    DeviceContext& context = device_->context();
    context.vk.vkAcquireNextImageKHR = real_acquire;
    context.vk.vkQueuePresentKHR = real_present;
    vkGetPhysicalDeviceSurfaceCapabilitiesKHR = real_capabilities;
    EXPECT_THAT(device_->validation_messages(), ::testing::IsEmpty());
  }

  /// fit(), and a picture of that size into the window as far as it comes.
  enum class Came { no_pixels, not_loaded, not_shown, shown };
  Came show() {
    glfwPollEvents();
    const SwapChain::Size size = chain_->fit(width_px, height_px);
    if (size.width_px == 0) return Came::no_pixels;
    EXPECT_EQ(size.width_px, width_px);
    EXPECT_EQ(size.height_px, height_px);
    if (!chain_->load(ImageRgba8(size.width_px, size.height_px))) return Came::not_loaded;
    return chain_->present() ? Came::shown : Came::not_shown;
  }

  static constexpr int width_px = 200, height_px = 120;
  static inline std::unique_ptr<VirtualDisplay> display_;
  static inline std::unique_ptr<Device> device_;
  static inline GLFWwindow* window_ = nullptr;
  bool has_window_ = true;
  int surfaces_ = 0;
  std::unique_ptr<SwapChain> chain_;
};

TEST_F(SwapChainFaults, AreMendedByTheNextPicture) {
  struct Fault {
    VkResult &where, result;
    Came came;
    int surfaces;  // made in all
  };
  const Fault faults[] = {
      {of_acquire, VK_ERROR_OUT_OF_DATE_KHR, Came::not_loaded, 1},
      {of_present, VK_ERROR_OUT_OF_DATE_KHR, Came::not_shown, 1},
      {of_present, VK_SUBOPTIMAL_KHR, Came::shown, 1},
      {of_acquire, VK_ERROR_SURFACE_LOST_KHR, Came::not_loaded, 2},
      {of_present, VK_ERROR_SURFACE_LOST_KHR, Came::not_shown, 3},
      {of_capabilities, VK_ERROR_SURFACE_LOST_KHR, Came::no_pixels, 4},
  };
  ASSERT_EQ(show(), Came::shown);
  for (const Fault& fault : faults) {
    fault.where = fault.result;
    EXPECT_EQ(show(), fault.came) << fault.result;
    EXPECT_EQ(fault.where, VK_SUCCESS) << "was not asked for";
    EXPECT_EQ(show(), Came::shown) << "after " << fault.result;
    EXPECT_EQ(show(), Came::shown) << "after " << fault.result;
    EXPECT_EQ(surfaces_, fault.surfaces) << "after " << fault.result;
  }
}

TEST_F(SwapChainFaults, OfADeviceOrAWindowThatIsGoneAreErrors) {
  ASSERT_EQ(show(), Came::shown);
  of_acquire = VK_ERROR_DEVICE_LOST;
  EXPECT_THROW(show(), Error);
  ASSERT_EQ(show(), Came::shown);
  of_acquire = VK_ERROR_SURFACE_LOST_KHR;
  EXPECT_EQ(show(), Came::not_loaded);
  has_window_ = false;
  try {
    show();
    ADD_FAILURE() << "shown without a window";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("brace run"));
  }
}

}  // namespace
}  // namespace brace::gpu
