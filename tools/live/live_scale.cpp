#include "tools/live/live_scale.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "tools/live/live_eyes.hpp"
#include "tools/live/window_picture.hpp"

namespace brace {

namespace {

/// Host time of the slower one of two head poses, at a scale.
double time_ms(const gpu::Device& device, const ReplayOptions& options, const LiveCommand& command,
               const StageRegistry& stages, const LiveHead& head, double scale) {
  Overrides overrides = parse_settings(command.set);
  overrides.emplace_back("device.resolution_scale", fmt::format("{}", scale));
  LiveEyes eyes(
      device, options, [&] { return LiveEyes::Read{read_session(command.session, overrides, stages)}; },
      head.at(SimTime()));
  double slowest_ms = 0.0;
  for (const SimTime time : {SimTime(), SimTime(from_s(2.0))}) {
    const Pose pose = head.at(time);
    double best_ms = 1e9;
    for (int i = 0; i < 3; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      (void)eyes.show(pose, [&] { return pose; });
      (void)eyes.read();
      best_ms = std::min(best_ms, to_s(SimDuration(std::chrono::steady_clock::now() - begin)) * 1e3);
    }
    slowest_ms = std::max(slowest_ms, best_ms);
  }
  return slowest_ms;
}

/// Host time of the window's picture, from the eyes' to the one handed over: the middle one of some. A
/// software device shares the processor with whatever shows the pictures, so that counts there; a GPU's is
/// waited for only by pictures that come too fast.
double window_ms(const gpu::Device& device, const LiveWindow& window) {
  gpu::SwapChain chain(device, window.make_surface());
  const ImageRgba8 eyes(200, 120);
  ImageRgba8 picture;
  std::vector<double> took_ms;
  for (int i = 0; i < 15; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    int width_px = 0, height_px = 0;
    window.size(width_px, height_px);
    const gpu::SwapChain::Size size = chain.fit(width_px, height_px);
    if (size.width_px == 0) return 0.0;
    if (picture.width_px != size.width_px || picture.height_px != size.height_px)
      picture = ImageRgba8(size.width_px, size.height_px);
    draw_fitted(eyes, {0, 0, size.width_px, size.height_px}, picture);
    if (!chain.load(picture) || !chain.present()) continue;
    took_ms.push_back(to_s(SimDuration(std::chrono::steady_clock::now() - begin)) * 1e3);
  }
  if (took_ms.empty()) return 0.0;
  std::sort(took_ms.begin(), took_ms.end());
  return device.info().limits.is_software ? took_ms[took_ms.size() / 2] : took_ms.front();
}

}  // namespace

LiveScale scale_for_rate(const gpu::Device& device, const ReplayOptions& options, const LiveCommand& command,
                         const StageRegistry& stages, const LiveHead& head, const LiveWindow& window) {
  const double asked =
      read_session(command.session, parse_settings(command.set), stages).device.resolution_scale;
  return choose_scale(asked, command.rate_hz, window_ms(device, window),
                      [&](double scale) { return time_ms(device, options, command, stages, head, scale); });
}

}  // namespace brace
