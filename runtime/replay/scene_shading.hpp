#pragma once

#include "runtime/raycast/eye_view.hpp"
#include "runtime/raycast/shading.hpp"
#include "runtime/session/session.hpp"

namespace brace {

/// What scene.shading asks for; `table_step_units`: the step that the transfer table has baked in.
SampledShading sampled_shading(const Session::Scene& scene, const VolumePlacement& placement,
                               double table_step_units);

}  // namespace brace
