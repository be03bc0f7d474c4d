#pragma once

#include <optional>
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
  double demand_min = 0.1;                      // coordinate 1; less than this is not told apart
  /// Of a replay in small: the headset's own pixels are this times the picture's.
  double resolution_scale = 1.0;
  /// For `radius`: the point whose farthest corner is at 1, so that a gaze that moves leaves lengths as they
  /// are; none: the gaze point.
  std::optional<glm::dvec2> reach_tan{};
  double demand_cap = 1e9;  // more is of no use: the finest level's scale
};

/// Where every pixel stands between fine and coarse.
struct LevelCoordinates {
  /// Rows top to bottom, 0 (finest) <= x <= 1: for `radius` the distance from the gaze point over that of the
  /// farthest corner (see reach_tan), 1 beyond; else coordinate_of(demand), demand the rays per pixel and
  /// axis that are of use.
  std::vector<float> x;
  double demand_min = 0.1;             // not for `radius`, as what follows
  std::vector<double> demand_of_rank;  // of all pixels, falling
  std::vector<float> x_of_rank;        // the radial map's coordinates, rising

  /// As many pixels have a larger demand as are nearer to the gaze point than the coordinate says, so that
  /// any map has the coordinates of the radial one, in another order; 1 from demand_min down. What has the
  /// same demand comes from the gaze point outwards.
  double coordinate_of(double demand) const;
};
LevelCoordinates level_coordinates(LevelMap map, const LevelMapInput& input);

/// Panel pixels per picture pixel along the denser axis of the lens' inverse Jacobian, largest of the three
/// channels, where the picture shows the tangents `t`; 0 beyond the usable radius. Above 1 where the picture
/// is coarser than the panel.
double lens_demand(const LevelMapInput& input, glm::dvec2 t);

/// Angular pitch of one of the headset's own picture pixels over the eye's minimum angle of resolution 1/48
/// deg + acuity_slope * eccentricity (Guenter et al. 2012, section 3). Above 1 where the eye resolves more
/// than there is.
double acuity_demand(const LevelMapInput& input, glm::dvec2 t);

}  // namespace brace
