#pragma once

#include "runtime/replay/headset.hpp"
#include "runtime/session/session.hpp"

namespace brace {

/// What a session's headset and head motion say of a pipeline's parts before anything is rendered.
struct SceneFacts {
  double px_per_deg = 0.0;   // of the panel at full scale, at the centre of the view
  double head_deg_s = 0.0;   // angular speed, p95 over the run
  double scan_out_ms = 0.0;  // from the first row lit to the last
  bool lens_does_nothing = false;
  bool channels_equal = false;
  double volume_distance_m = 0.0;  // from the first pose to the nearest point of its bounding sphere; above 0

  /// Pixels that the view moves by while a rolling panel is lit.
  double scan_out_px() const { return head_deg_s * scan_out_ms * 1e-3 * px_per_deg; }
  /// Pixels that a picture is off whose orientation and position are off.
  double off_px(double angular_error_deg, double position_error_mm) const;
};

SceneFacts scene_facts(const Session& session, const Headset& headset, const HeadTrace& trace);

}  // namespace brace
