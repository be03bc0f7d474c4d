#include <algorithm>
#include <cmath>

#include "tests/unit/verify/planted_defects.hpp"

namespace brace {

std::vector<PlantedDefect> defects_in_stereo_and_control() {
  return {
      // Stereo.
      {"one layer short: the fencepost", "stereo",
       [](VerifySubjects& s) {
         s.layer_count = [](const StereoOptics& optics, double radius_m, double near_m) {
           return layer_count(optics, radius_m, near_m) - 1;
         };
       }},
      {"near plane by the difference of two large numbers", "stereo",
       [](VerifySubjects& s) {
         s.near_plane_m = [](const StereoOptics& optics, double radius_m, double disparity_px) {
           const double q = 2 * optics.eye_distance_m * optics.pixels_per_tangent * radius_m / disparity_px;
           return -radius_m + std::sqrt(radius_m * radius_m + q);
         };
       }},
      {"near plane by eq. 22 with d for the radius", "stereo",
       [](VerifySubjects& s) {
         s.near_plane_m = [](const StereoOptics& optics, double radius_m, double disparity_px) {
           return near_plane_m(optics, radius_m / 2, disparity_px);
         };
       }},
      {"disparity range over one denominator", "stereo",
       [](VerifySubjects& s) {
         s.disparity_range_px = [](const StereoOptics& optics, double z_near_m, double z_far_m) {
           return optics.eye_distance_m * optics.pixels_per_tangent * (z_far_m - z_near_m) /
                  (z_near_m * z_far_m);
         };
       }},
      {"disparity of a sphere by cancelling quotients", "stereo",
       [](VerifySubjects& s) {
         s.disparity_range_of_sphere_px = [](const StereoOptics& optics, double radius_m, double near_m) {
           return disparity_range_px(optics, near_m, near_m + 2 * radius_m);
         };
       }},
      {"layers for a range without its fraction", "stereo",
       [](VerifySubjects& s) {
         s.interference_free_layers = [](double range_px, double) { return static_cast<int>(range_px) + 1; };
       }},
      {"path lengths of the first eye for the second", "stereo",
       [](VerifySubjects& s) {
         s.compose_scan_line = [](const StereoGeometry& geometry, const ScanRow& row, int width_px,
                                  const PathLengths&) { return compose_scan_line(geometry, row, width_px); };
       }},
      {"eyes the wrong way round", "stereo",
       [](VerifySubjects& s) {
         s.compose_scan_line = [](StereoGeometry geometry, const ScanRow& row, int width_px,
                                  const PathLengths& lengths) {
           geometry.shift_px -= 20.0;
           return compose_scan_line(geometry, row, width_px, lengths);
         };
       }},
      // Control.
      {"stability of a frame less of delay", "control",
       [](VerifySubjects& s) {
         s.pi_control_is_stable = [](double p, double i, std::uint32_t delay) {
           return stages::pi_control_is_stable(p, i, delay == 0 ? 0 : delay - 1);
         };
       }},
      {"a miss takes a fixed step", "control",
       [](VerifySubjects& s) {
         s.quantile_control = [make = s.quantile_control](bool) { return make(false); };
       }},
      {"a miss takes half", "control",
       [](VerifySubjects& s) {
         s.quantile_control = [make = s.quantile_control](bool) {
           return [update = make(false), n = 0](const stages::FrameLoad& load) mutable {
             return load.missed && ++n % 2 == 0 ? update({0.5, false}) : update(load);
           };
         };
       }},
      {"quality that is never given back", "control",
       [](VerifySubjects& s) {
         s.quantile_control = [make = s.quantile_control](bool cut) {
           return [update = make(cut), least = 1.0](const stages::FrameLoad& load) mutable {
             return least = std::min(least, update(load));
           };
         };
       }},
      {"integral part that winds up", "control",
       [](VerifySubjects& s) {
         s.pi_control = [] {
           return [u = 0.0](const stages::FrameLoad& load) mutable {
             u -= 0.3 * std::log(std::clamp(load.cost, 1e-13, 1e13) / 0.85);
             return std::clamp(std::exp(u), 0.05, 1.0);
           };
         };
       }},
      {"PI control a twentieth below its target", "control",
       [](VerifySubjects& s) {
         s.pi_control = [make = s.pi_control] {
           return [update = make()](const stages::FrameLoad& load) {
             return update({1.05 * load.cost, load.missed});
           };
         };
       }},
      {"a window that never closes", "control",
       [](VerifySubjects& s) {
         s.window_control = [] { return [](const stages::FrameLoad&) { return 1.0; }; };
       }},
      {"not a number from a cost of nothing", "control",
       [](VerifySubjects& s) {
         s.window_control = [make = s.window_control] {
           return [update = make()](const stages::FrameLoad& load) {
             return load.cost == 0.0 ? std::nan("") : update(load);
           };
         };
       }},
      // Schedule.
      {"every prediction is zero", "schedule",
       [](VerifySubjects& s) {
         s.cell_schedule = [make = s.cell_schedule](const ChunkedParams& params) {
           CellFunctions cells = make(params);
           cells.next = [next = cells.next_in_any_case](SimDuration) { return next(); };
           return cells;
         };
       }},
      {"a load step is not learned from", "schedule",
       [](VerifySubjects& s) {
         s.cell_schedule = [make = s.cell_schedule](const ChunkedParams& params) {
           CellFunctions cells = make(params);
           cells.trace = [trace = cells.trace](const CellSchedule::Cell& cell, SimDuration cost) {
             trace({cell.number, cost}, cost / 10);
           };
           return cells;
         };
       }},
      {"the last cell is left out", "schedule",
       [](VerifySubjects& s) {
         s.cell_schedule = [make = s.cell_schedule](const ChunkedParams& params) {
           CellFunctions cells = make(params);
           cells.left = [left = cells.left] { return left() - 1; };
           return cells;
         };
       }},
  };
}

}  // namespace brace
