#include "tools/live/live_scale.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/core.h>

#include "tools/live/live_eyes.hpp"

namespace brace {

namespace {

constexpr double probe_scale = 0.1;
constexpr double scale_min = 0.03;

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

}  // namespace

double scale_for_rate(const gpu::Device& device, const ReplayOptions& options, const LiveCommand& command,
                      const StageRegistry& stages, const LiveHead& head) {
  const double asked =
      read_session(command.session, parse_settings(command.set), stages).device.resolution_scale;
  const double budget_ms = 0.6e3 / command.rate_hz;  // the window takes time, too
  double scale = std::min(probe_scale, asked);
  double took_ms = time_ms(device, options, command, stages, head, scale);
  if (took_ms < budget_ms) return std::min(scale * std::sqrt(budget_ms / took_ms), asked);
  for (int step = 0; step < 5 && took_ms > budget_ms && scale > scale_min; ++step) {
    scale = std::max(scale * std::min(std::sqrt(budget_ms / took_ms), 0.8), std::min(scale_min, asked));
    took_ms = time_ms(device, options, command, stages, head, scale);
  }
  return scale;
}

}  // namespace brace
