#include "runtime/plan/scene_facts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/metrics/pacing.hpp"

namespace brace {

namespace {

constexpr double deg_per_rad = 180.0 / std::numbers::pi;
constexpr double nearest_m = 0.05;  // a head inside the volume

/// p95 of the angular speed between the trace's poses from start to end of the run; gaps do not count.
double head_speed_deg_s(const sim::PoseTrace& trace, double start_s) {
  const SimTime from = trace.begin_time() + from_s(start_s);
  std::vector<double> speeds;
  const auto& poses = trace.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const SimDuration between = poses[i].time - poses[i - 1].time;
    if (poses[i - 1].time < from || between > sim::trace_gap) continue;
    const double angle = glm::length(quat_log(glm::inverse(poses[i - 1].world_from_head.orientation) *
                                              poses[i].world_from_head.orientation));
    speeds.push_back(angle * deg_per_rad / to_s(between));
  }
  return speeds.empty() ? 0.0 : distribution_of(std::move(speeds)).p95;
}

/// Panel pixels per degree where the view's centre is shown.
double px_per_degree(const Headset& headset) {
  const sim::EyeProfile& eye = headset.profile.eyes[0];
  constexpr double small = 1e-3;  // tangent
  const auto at = sim::tangents_to_panel(eye.lens, sim::Channel::green, {0.0, 0.0});
  const auto beside = sim::tangents_to_panel(eye.lens, sim::Channel::green, {small, 0.0});
  if (!at || !beside) return headset.profile.panel_width_px / (eye.fov.width() * deg_per_rad);
  const double px = std::abs(beside->x - at->x) * headset.profile.panel_width_px;
  return px / (small * deg_per_rad);
}

}  // namespace

double SceneFacts::off_px(double angular_error_deg, double position_error_mm) const {
  const double parallax_deg = std::atan2(position_error_mm * 1e-3, volume_distance_m) * deg_per_rad;
  return (angular_error_deg + parallax_deg) * px_per_deg;
}

SceneFacts scene_facts(const Session& session, const Headset& headset, const HeadTrace& trace) {
  SceneFacts facts;
  facts.px_per_deg = px_per_degree(headset);
  facts.head_deg_s = head_speed_deg_s(trace.trace, session.trace.start_s);
  const sim::ScanOut& scan_out = headset.profile.scan_out;
  if (scan_out.direction != sim::ScanDirection::global)
    facts.scan_out_ms = scan_out.fraction * 1e3 / headset.profile.refresh.hz();
  facts.lens_does_nothing = lens_does_nothing(headset);
  facts.channels_equal = channels_equal(headset);
  const Pose first = trace.trace.at(trace.trace.begin_time() + from_s(session.trace.start_s),
                                    sim::Interpolation::slerp_linear);
  const VolumePlacement placement = place_volume(session.scene, first);
  const double centre_m = glm::length(placement.world_from_volume.position - first.position);
  facts.volume_distance_m = std::max(nearest_m, centre_m - 0.5 * session.scene.size_m);
  return facts;
}

}  // namespace brace
