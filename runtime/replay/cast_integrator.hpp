#pragma once

#include <optional>

#include "runtime/host/stage_registry.hpp"
#include "runtime/raycast/transfer_on_device.hpp"
#include "runtime/session/session.hpp"

namespace brace {

/// What a cast stage's parameters ask to be kept of the transfer function: a choice `integrator` with
/// "pre-integrated" and, with fixed steps, a choice `preintegration` with "table". Throws input_error for a
/// combination of parameters that means nothing.
TransferExtras transfer_extras(const PipelineStage& cast);

/// Whether a cast stage samples coarser levels of the volume: a choice `lod` that is not "off".
bool wants_levels(const PipelineStage& cast);

/// The session with steps a quarter as long, fixed, pre-integrated and of the finest level; empty unless
/// cast/dvr casts it.
std::optional<Session> converged_session(const Session& session);

}  // namespace brace
