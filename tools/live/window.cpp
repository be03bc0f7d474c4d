#include "tools/live/window.hpp"

#include <algorithm>

#include <vulkan/vulkan_core.h>
// After Vulkan's own types, so that GLFW declares its functions for them.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr double rad_per_px = 0.004;

[[noreturn]] void no_window(const std::string& why) {
  throw device_error(
      "live: cannot open a window ({}); without a display: xvfb-run brace live SESSION.toml --frames 60 "
      "--screenshot eyes.png, or `brace run`, which needs none",
      why);
}

std::string glfw_words() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words != nullptr ? words : "no reason given";
}

}  // namespace

LiveWindow::LiveWindow(int width_px, int height_px, const std::string& title) {
  if (glfwInit() != GLFW_TRUE) no_window(glfw_words());
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  window_ = glfwCreateWindow(width_px, height_px, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr || glfwVulkanSupported() != GLFW_TRUE) {
    const std::string why = glfw_words();
    glfwTerminate();
    no_window(why);
  }
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, on_key);
  glfwSetCursorPosCallback(window_, on_cursor);
  glfwGetCursorPos(window_, &cursor_x_, &cursor_y_);
}

LiveWindow::~LiveWindow() {
  if (overlay_attached_) ImGui_ImplGlfw_Shutdown();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void LiveWindow::attach_overlay() {
  ImGui_ImplGlfw_InitForVulkan(window_, true);
  overlay_attached_ = true;
}

void LiveWindow::feed_overlay() const {
  ImGui_ImplGlfw_NewFrame();
}

std::vector<std::string> LiveWindow::vulkan_extensions() const {
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  return std::vector<std::string>(names, names + count);
}

gpu::MakeSurface LiveWindow::make_surface() const {
  return [window = window_](VkInstance_T* instance) {
    VkSurfaceKHR surface = nullptr;
    return glfwCreateWindowSurface(instance, window, nullptr, &surface) == VK_SUCCESS ? surface : nullptr;
  };
}

void LiveWindow::on_key(GLFWwindow* window, int key, int, int action, int) {
  if (action == GLFW_PRESS)
    static_cast<LiveWindow*>(glfwGetWindowUserPointer(window))->pressed_.push_back(key);
}

void LiveWindow::on_cursor(GLFWwindow* window, double x, double y) {
  auto& self = *static_cast<LiveWindow*>(glfwGetWindowUserPointer(window));
  self.cursor_x_ = x;
  self.cursor_y_ = y;
}

double LiveWindow::held(int key) const {
  return glfwGetKey(window_, key) == GLFW_PRESS ? 1.0 : 0.0;
}

bool LiveWindow::poll(bool widget_has_mouse, bool widget_has_keys) {
  pressed_.clear();
  glfwPollEvents();
  head_ = {};
  if (widget_has_keys) {
    pressed_.clear();
  } else {
    head_.right =
        std::max(held(GLFW_KEY_D), held(GLFW_KEY_RIGHT)) - std::max(held(GLFW_KEY_A), held(GLFW_KEY_LEFT));
    head_.forward =
        std::max(held(GLFW_KEY_W), held(GLFW_KEY_UP)) - std::max(held(GLFW_KEY_S), held(GLFW_KEY_DOWN));
    head_.up = held(GLFW_KEY_E) - held(GLFW_KEY_Q);
  }
  const double x = cursor_x_, y = cursor_y_;
  const auto down = [&](int button) { return glfwGetMouseButton(window_, button) == GLFW_PRESS; };
  mouse_in_use_ =
      x != mouse_x_ || y != mouse_y_ || down(GLFW_MOUSE_BUTTON_LEFT) || down(GLFW_MOUSE_BUTTON_RIGHT);
  const bool button = !widget_has_mouse && down(GLFW_MOUSE_BUTTON_LEFT);
  if (button && dragging_) {
    head_.turn_right_rad = (x - mouse_x_) * rad_per_px;
    head_.turn_up_rad = (mouse_y_ - y) * rad_per_px;
  }
  dragging_ = button;
  mouse_x_ = x;
  mouse_y_ = y;
  const bool escape = std::find(pressed_.begin(), pressed_.end(), GLFW_KEY_ESCAPE) != pressed_.end();
  return glfwWindowShouldClose(window_) == GLFW_FALSE && !escape;
}

bool LiveWindow::pressed(char key) const {
  return std::find(pressed_.begin(), pressed_.end(), static_cast<int>(key)) != pressed_.end();
}

void LiveWindow::size(int& width_px, int& height_px) const {
  glfwGetFramebufferSize(window_, &width_px, &height_px);
}

void LiveWindow::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

}  // namespace brace
