#pragma once

#include <string>

#include "runtime/plan/plan.hpp"
#include "runtime/replay/replay.hpp"

namespace brace {

/// What became of pipeline.cast = "auto".
struct CastDecision {
  Overrides settings;  // that a session is to be read with; empty where it names its raycaster
  std::string reason;  // for Session::cast_reason
};

/// cast/native where it is installed, has what the session sets, works with its other stages and is clearly
/// faster by measurement (cast_choice.hpp); else, and on every GPU, cast/dvr. What the session sets for
/// cast/dvr goes for either. `read` reads the session with more settings.
CastDecision decide_cast(const SessionReader& read, const StageRegistry& stages,
                         const ReplayOptions& options);

}  // namespace brace
