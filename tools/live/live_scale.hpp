#pragma once

#include "runtime/gpu/device.hpp"
#include "tools/command.hpp"
#include "tools/live/live_head.hpp"

namespace brace {

/// A resolution_scale, at most the session's, at which this device holds the rate. Time falls slower than the
/// pixels where a few of them take most of it, so it is measured anew at each step down.
double scale_for_rate(const gpu::Device& device, const ReplayOptions& options, const LiveCommand& command,
                      const StageRegistry& stages, const LiveHead& head);

}  // namespace brace
