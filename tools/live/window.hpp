#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/gpu/swap_chain.hpp"
#include "tools/live/head_control.hpp"

struct GLFWwindow;

namespace brace {

/// A window of the desktop (GLFW), and what is done in it.
class LiveWindow {
 public:
  /// Throws device_error where there is no display, naming Xvfb and `brace run`.
  LiveWindow(int width_px, int height_px, const std::string& title);
  ~LiveWindow();
  LiveWindow(const LiveWindow&) = delete;
  LiveWindow& operator=(const LiveWindow&) = delete;

  /// Of the window system, for DeviceOptions.
  std::vector<std::string> vulkan_extensions() const;
  gpu::MakeSurface make_surface() const;

  /// From now on Dear ImGui is told what mouse and keys do. Its context must live until the window goes.
  void attach_overlay();
  /// Tells it of the frame to come.
  void feed_overlay() const;

  /// Takes what has happened; false once the window is to be closed. Mouse and keys that a widget of the
  /// overlay has are not the head's.
  bool poll(bool widget_has_mouse, bool widget_has_keys);
  /// Since the last poll().
  const HeadInput& head() const { return head_; }
  bool pressed(char key) const;                        // letters in upper case, ' '
  bool mouse_in_use() const { return mouse_in_use_; }  // moved, or with a button held

  void size(int& width_px, int& height_px) const;
  void set_title(const std::string& title);

 private:
  static void on_key(GLFWwindow* window, int key, int code, int action, int mods);
  static void on_cursor(GLFWwindow* window, double x, double y);
  double held(int key) const;

  GLFWwindow* window_ = nullptr;
  HeadInput head_;
  std::vector<int> pressed_;
  // As the window system has told of itself: to ask for it is to wait until the last picture is shown.
  double cursor_x_ = 0.0, cursor_y_ = 0.0;
  double mouse_x_ = 0.0, mouse_y_ = 0.0;  // at the last poll()
  bool dragging_ = false, mouse_in_use_ = false, overlay_attached_ = false;
};

}  // namespace brace
