#include "runtime/plan/scene_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/metrics/pacing.hpp"
#include "runtime/stereo/layer_count.hpp"

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

std::optional<double> SceneFacts::disparity_px() const {
  if (!volume) return std::nullopt;
  const StereoOptics optics{eye_distance_m, pixels_per_tangent};
  return disparity_range_of_sphere_px(optics, volume->bounding_radius_m, volume_distance_m);
}

VolumeFacts volume_facts(const std::vector<TransferTable>& tables, const std::vector<double>& occupancies,
                         ValueRange data, double step_voxels) {
  VolumeFacts facts;
  facts.kappa_dt_min = std::numeric_limits<double>::infinity();
  facts.visible = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const double occupancy : occupancies)
    facts.occupancy += occupancy / static_cast<double>(occupancies.size());
  for (const TransferTable& table : tables) {
    const double unit = (table.range.max - table.range.min) / static_cast<double>(table.entries.size() - 1);
    double visible = 0.0;
    const auto kappa = [&](std::size_t i) { return table.entries[i][3]; };
    for (std::size_t i = 0; i < table.entries.size(); ++i) {
      const double value = table.range.min + unit * static_cast<double>(i);
      // Tables are interpolated linearly: between two entries something is visible if it is at either.
      const double low = std::max(value, data.min), high = std::min(value + unit, data.max);
      if (i + 1 < table.entries.size() && low < high && kappa(i) + kappa(i + 1) > 0.0) {
        visible += high - low;
        facts.visible = {std::min(facts.visible.min, low), std::max(facts.visible.max, high)};
      }
      if (!(kappa(i) > 0.0) || value < data.min - unit || value > data.max + unit) continue;
      facts.kappa_dt_min = std::min(facts.kappa_dt_min, kappa(i) * step_voxels);
      facts.kappa_dt_max = std::max(facts.kappa_dt_max, kappa(i) * step_voxels);
    }
    if (data.max > data.min)
      facts.visible_values = std::max(facts.visible_values, visible / (data.max - data.min));
  }
  if (data.max == data.min && facts.kappa_dt_max > 0.0) {  // one value, and it is visible
    facts.visible_values = 1.0;
    facts.visible = data;
  }
  if (facts.kappa_dt_max == 0.0) {
    facts.kappa_dt_min = 0.0;
    facts.visible = {};
  }
  return facts;
}

SceneFacts scene_facts(const Session& session, const Headset& headset, const HeadTrace& trace) {
  SceneFacts facts;
  facts.px_per_deg = px_per_degree(headset);
  facts.head_deg_s = head_speed_deg_s(trace.trace, session.trace.start_s);
  const sim::ScanOut& scan_out = headset.profile.scan_out;
  if (scan_out.direction != sim::ScanDirection::global)
    facts.scan_out_ms = scan_out.fraction * 1e3 / headset.profile.refresh.hz();
  facts.scan_direction = scan_out.direction;
  for (const sim::Eye eye : sim::all_eyes)
    facts.lenses[static_cast<std::size_t>(eye)] = headset.profile.eye(eye).lens;
  facts.eye_distance_m = headset.profile.ipd_m();
  facts.pixels_per_tangent = headset.eye.width_px / headset.profile.eye(sim::Eye::right).fov.width();
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
