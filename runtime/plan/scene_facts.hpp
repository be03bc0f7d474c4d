#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "runtime/replay/headset.hpp"
#include "runtime/session/session.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {

/// What a transfer function makes of a volume.
struct VolumeFacts {
  double occupancy = 0.0;       // share of the blocks of skip stages that something is visible in
  double visible_values = 0.0;  // share of the data's range of values that is visible
  ValueRange visible;           // from the first visible value to the last; where some are
  double kappa_dt_min = 0.0, kappa_dt_max = 0.0;  // optical depth of a step, over the visible values
  double bounding_radius_m = 0.0;                 // half the box's diagonal
};

/// Of tables that are in force one after the other, each with its occupancy. `data`: the volume's values,
/// within the tables' range; `step_voxels`: distance between samples in the smallest voxel spacing.
VolumeFacts volume_facts(const std::vector<TransferTable>& tables, const std::vector<double>& occupancies,
                         ValueRange data, double step_voxels);

/// What a session's headset and head motion say of a pipeline's parts before anything is rendered.
struct SceneFacts {
  double px_per_deg = 0.0;   // of the panel at full scale, at the centre of the view
  double head_deg_s = 0.0;   // angular speed, p95 over the run
  double scan_out_ms = 0.0;  // from the first row lit to the last
  bool lens_does_nothing = false;
  bool channels_equal = false;
  double volume_distance_m = 0.0;  // from the first pose to the nearest point of its bounding sphere; above 0
  sim::ScanDirection scan_direction = sim::ScanDirection::global;
  std::array<sim::EyeLens, 2> lenses;  // by sim::Eye
  double eye_distance_m = 0.0;
  double pixels_per_tangent = 0.0;    // of the eye frame as rendered
  std::optional<VolumeFacts> volume;  // where something is rendered

  /// Pixels that the view moves by while a rolling panel is lit.
  double scan_out_px() const { return head_deg_s * scan_out_ms * 1e-3 * px_per_deg; }
  /// Pixels of the eye frame that the eyes see the volume's nearest and farthest point apart by: s d_r of
  /// Buchacher's eq. 21 for the bounding sphere; none without a volume.
  std::optional<double> disparity_px() const;
  /// Pixels that a picture is off whose orientation and position are off.
  double off_px(double angular_error_deg, double position_error_mm) const;
};

/// Without what the volume says.
SceneFacts scene_facts(const Session& session, const Headset& headset, const HeadTrace& trace);

/// A line per fact: its name, its figures.
struct FactLine {
  std::string name, figure;
};
std::vector<FactLine> fact_lines(const SceneFacts& facts);

}  // namespace brace
