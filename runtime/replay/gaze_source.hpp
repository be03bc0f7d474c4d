#pragma once

#include <array>
#include <optional>
#include <vector>

#include "runtime/frame/gaze_motion.hpp"
#include "runtime/replay/headset.hpp"

namespace brace {

/// The eyes of a session: as gaze.script says, or the trace; empty if neither does. `head` must outlive it.
/// Throws input_error where rays/mab is to follow what there is not.
std::optional<GazeMotion> make_gaze(const Session& session, const sim::PoseTrace& trace, HeadMotion& head);

/// What the eye resolves of the panels with a gaze: per pixel (MAR(0) / MAR(theta))^2, MAR = 1/48 degree +
/// 0.022 theta (Guenter et al. 2012), theta the angle from the gaze to where the pixel is seen through the
/// lens (the green channel); 0 where it is not seen.
class GazeWeights {
 public:
  explicit GazeWeights(const Headset& headset);

  /// Row-major; valid until the next call for this eye. `gaze`: unit vector in the head frame.
  const std::vector<float>& of(sim::Eye eye, const glm::dvec3& gaze);

 private:
  struct EyeWeights {
    std::vector<glm::dvec3> directions;  // per panel pixel, in the head frame; zero: not seen
    std::vector<float> weights;
    glm::dvec3 gaze{0.0};  // of `weights`
  };
  std::array<EyeWeights, 2> eyes_;
};

}  // namespace brace
