#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "hmd_sim/lens.hpp"

namespace brace {

/// By what the levels of rays/mab are laid over an eye's picture.
enum class LevelMap {
  radius,            // distance from the gaze point (Waschk & Krueger 2021, section 3)
  lens,              // how densely the panel samples the picture through the lens (FAVR's idea)
  eccentricity,      // what the eye resolves at an angle from the gaze point
  lens_eccentricity  // the product of both demands
};

struct LevelMapInput {
  const sim::EyeLens& lens;
  sim::FovTangents fov;
  int width_px = 0, height_px = 0;              // of the eye's picture
  int panel_width_px = 0, panel_height_px = 0;  // of the panel behind the lens
  glm::dvec2 gaze_tan{0.0};                     // tangents of the gaze direction in the eye frame
  double acuity_slope = 0.0275;                 // see acuity_demand
  double resolution_scale =
      1.0;  // of a replay in small: what the headset's own pixels are times the picture's
};

/// The coordinate x of every pixel, rows top to bottom, 0 (finest) <= x <= 1: for `radius` the distance from
/// the gaze point over that of the farthest corner; else 1 - demand, demand the rays per pixel and axis that
/// are of use.
std::vector<float> level_coordinates(LevelMap map, const LevelMapInput& input);

/// Panel pixels per picture pixel along the denser axis of the lens' inverse Jacobian, largest of the three
/// channels, where the picture shows the tangents `t`; 0 beyond the usable radius. At most 1.
double lens_demand(const LevelMapInput& input, glm::dvec2 t);

/// Angular pitch of one of the headset's own picture pixels over the eye's minimum angle of resolution 1/48
/// deg + acuity_slope * eccentricity (Guenter et al. 2012, section 3). At most 1.
double acuity_demand(const LevelMapInput& input, glm::dvec2 t);

}  // namespace brace
