#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/image.hpp"
#include "runtime/gpu/device.hpp"

struct VkInstance_T;
struct VkSurfaceKHR_T;

namespace brace::gpu {

/// Makes a window's surface for an instance; null on failure.
using MakeSurface = std::function<VkSurfaceKHR_T*(VkInstance_T* instance)>;

/// The pictures of a window. A swap-chain that is out of date, and a surface that is lost, are made anew by
/// the next fit(). The device must have been made with DeviceOptions::window_extensions and must outlive it;
/// so must the window.
class SwapChain {
 public:
  /// Throws device_error when the device cannot show anything in this window.
  SwapChain(const Device& device, const MakeSurface& make_surface);
  ~SwapChain();
  SwapChain(const SwapChain&) = delete;
  SwapChain& operator=(const SwapChain&) = delete;

  /// Pixels that a picture must have, for a window of this many; 0 x 0 while it has none (minimised).
  struct Size {
    int width_px = 0, height_px = 0;
  };
  Size fit(int window_width_px, int window_height_px);

  /// Takes a picture of the size that fit() said last, once the window system has room for it. False when the
  /// window has changed meanwhile: fit() and try again.
  bool load(const ImageRgba8& picture);
  /// Shows what load() took last, which was true; waits for the display as the window system does. False when
  /// the window has changed meanwhile.
  bool present();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace brace::gpu
