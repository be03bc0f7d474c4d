#include "runtime/replay/gaze_source.hpp"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "runtime/mab/mab_plan.hpp"

namespace brace {

namespace {

/// Throws where rays/mab is to follow a gaze that is not there.
void require_gaze(const Session& session, const sim::PoseTrace& trace) {
  const PipelineStage& rays = session.pipeline.at("rays");
  if (rays.stage.id() != "rays/mab") return;
  const MabGaze wanted = mab_settings(rays).gaze;
  const bool scripted = !session.gaze.script.empty();
  if (wanted == MabGaze::script && !scripted) {
    throw input_error(
        "{}: rays/mab: gaze = 'script', but there is no 'gaze.script'; accepted: a list of "
        "[seconds, x, y]",
        session.file.string());
  }
  if (wanted != MabGaze::trace) return;
  if (scripted) {
    throw input_error(
        "{}: rays/mab: gaze = 'trace' beside 'gaze.script', which says where the eyes look; "
        "accepted: gaze = 'script', or no script",
        session.file.string());
  }
  if (!trace.has_gaze()) {
    throw input_error(
        "{}: rays/mab: gaze = 'trace', but trace '{}' has no columns gaze_x gaze_y gaze_z; "
        "accepted: a trace with gaze (`brace trace info` tells), or gaze = 'fixed' or 'script'",
        session.file.string(), trace.name());
  }
}

float acuity_weight(double angle_rad) {
  constexpr double foveal_rad = std::numbers::pi / 180.0 / 48.0, slope = 0.022;
  const double share = foveal_rad / (foveal_rad + slope * angle_rad);
  return static_cast<float>(share * share);
}

}  // namespace

std::optional<GazeMotion> make_gaze(const Session& session, const sim::PoseTrace& trace, HeadMotion& head) {
  require_gaze(session, trace);
  const SimDuration latency = from_s(session.gaze.latency_ms * 1e-3);
  if (!session.gaze.script.empty()) {
    std::vector<GazePoint> script;
    for (const Session::Gaze::Point& point : session.gaze.script)
      script.push_back({SimTime(from_s(point.at_s)), {point.x, point.y}});
    return GazeMotion(std::move(script), latency);
  }
  if (trace.has_gaze()) return GazeMotion(head, latency);
  return {};
}

GazeWeights::GazeWeights(const Headset& headset) {
  for (const sim::Eye which : sim::all_eyes) {
    const sim::EyeProfile& eye = headset.profile.eye(which);
    const double usable = sim::usable_radius(eye.lens, sim::Channel::green);
    std::vector<glm::dvec3>& directions = eyes_[static_cast<std::size_t>(which)].directions;
    for (int y = 0; y < headset.panel.height_px; ++y)
      for (int x = 0; x < headset.panel.width_px; ++x) {
        const glm::dvec2 uv((x + 0.5) / headset.panel.width_px, (y + 0.5) / headset.panel.height_px);
        const auto tan = sim::panel_to_tangents(eye.lens, sim::Channel::green, usable, uv);
        directions.push_back(tan ? eye.head_from_eye.orientation * glm::normalize(glm::dvec3(*tan, -1.0))
                                 : glm::dvec3(0.0));
      }
  }
}

const std::vector<float>& GazeWeights::of(sim::Eye which, const glm::dvec3& gaze) {
  EyeWeights& eye = eyes_[static_cast<std::size_t>(which)];
  if (eye.gaze == gaze) return eye.weights;
  eye.gaze = gaze;
  eye.weights.clear();
  for (const glm::dvec3& direction : eye.directions) {
    const bool seen = direction != glm::dvec3(0.0);
    const double angle_rad = std::atan2(glm::length(glm::cross(direction, gaze)), glm::dot(direction, gaze));
    eye.weights.push_back(seen ? acuity_weight(angle_rad) : 0.0f);
  }
  return eye.weights;
}

}  // namespace brace
