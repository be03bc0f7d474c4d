#pragma once

#include "runtime/gpu/device.hpp"
#include "tools/command.hpp"
#include "tools/live/live_head.hpp"
#include "tools/live/scale_choice.hpp"
#include "tools/live/window.hpp"

namespace brace {

/// choose_scale() for a session on this device in this window, both measured.
LiveScale scale_for_rate(const gpu::Device& device, const ReplayOptions& options, const LiveCommand& command,
                         const StageRegistry& stages, const LiveHead& head, const LiveWindow& window);

}  // namespace brace
