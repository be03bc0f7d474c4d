#include "runtime/frame/gaze_motion.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace brace {

GazeMotion::GazeMotion(std::vector<GazePoint> script, SimDuration latency)
    : script_(std::move(script)), latency_(latency) {
  if (script_.empty()) throw input_error("a scripted gaze has no place; accepted: one or more");
  const auto falls = [](const GazePoint& a, const GazePoint& b) { return b.time < a.time; };
  if (std::adjacent_find(script_.begin(), script_.end(), falls) != script_.end())
    throw input_error("a scripted gaze goes back in time; accepted: times that do not fall");
}

glm::dvec3 GazeMotion::true_at(SimTime time) {
  if (head_ != nullptr) return head_->true_gaze(time);
  const auto after = std::upper_bound(script_.begin(), script_.end(), time,
                                      [](SimTime t, const GazePoint& point) { return t < point.time; });
  if (after == script_.begin()) return sim::direction_of_tangents(script_.front().tan);
  const GazePoint& from = *(after - 1);
  if (after == script_.end()) return sim::direction_of_tangents(from.tan);
  const double s = to_s(time - from.time) / to_s(after->time - from.time);
  return sim::direction_of_tangents(from.tan + s * (after->tan - from.tan));
}

}  // namespace brace
