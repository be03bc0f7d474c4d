#pragma once

#include "runtime/replay/scene.hpp"

namespace brace {

/// Fills skip_stage: the session's own, or for pipeline.skip = "auto" the one that choose_skip takes for the
/// scene, with the reason, which goes to stderr too if `messages`. Needs volume, statistics, versions and
/// skip_kernels.
void choose_skip_stage(const Session& session, SceneOnDevice& scene, bool messages);

}  // namespace brace
