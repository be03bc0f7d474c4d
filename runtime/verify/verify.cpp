#include "runtime/verify/verify.hpp"

#include <memory>

#include "runtime/metrics/image_error.hpp"

namespace brace {

namespace {

template <typename Control>
QualityUpdate update_of(const typename Control::Settings& settings) {
  const auto control = std::make_shared<Control>(settings);
  return [control](const stages::FrameLoad& load) { return control->update(load); };
}

CellFunctions cell_functions(const ChunkedParams& params) {
  const auto schedule = std::make_shared<CellSchedule>(params);
  using Cell = CellSchedule::Cell;
  return {[schedule] { schedule->begin_frame(); },
          [schedule] { return schedule->left(); },
          [schedule](SimDuration budget) { return schedule->next(budget); },
          [schedule] { return schedule->next_in_any_case(); },
          [schedule](const Cell& cell) { schedule->hand_out(cell); },
          [schedule](const Cell& cell, SimDuration cost) { schedule->trace(cell, cost); }};
}

void add_stereo(VerifySubjects& subjects) {
  subjects.disparity_range_px = disparity_range_px;
  subjects.disparity_range_of_sphere_px = disparity_range_of_sphere_px;
  subjects.near_plane_m = near_plane_m;
  subjects.layer_count = layer_count;
  subjects.interference_free_layers = interference_free_layers;
  subjects.compose_scan_line = compose_scan_line;
}

void add_load_control(VerifySubjects& subjects) {
  subjects.pi_control_is_stable = stages::pi_control_is_stable;
  subjects.pi_control = [] { return update_of<stages::PiControl>({}); };
  subjects.window_control = [] { return update_of<stages::WindowControl>({}); };
  subjects.quantile_control = [](bool proportional_cut) {
    stages::QuantileControl::Settings settings;
    settings.proportional_cut = proportional_cut;
    return update_of<stages::QuantileControl>(settings);
  };
  subjects.cell_schedule = cell_functions;
}

}  // namespace

VerifySubjects product_subjects(Caster& caster, const std::filesystem::path& data_folder) {
  VerifySubjects subjects;
  subjects.cast = [&caster](const CastCase& wanted) { return caster(wanted); };
  subjects.run_stability = run_stability;
  subjects.accumulate = accumulate;
  subjects.kappa_from_opacity = kappa_from_opacity;
  subjects.opacity_from_kappa = opacity_from_kappa;
  subjects.opacity_corrected = opacity_corrected;
  subjects.integrate = integrate;
  subjects.lens_forward = sim::lens_forward;
  subjects.lens_inverse = sim::lens_inverse;
  subjects.fold_over_radius = sim::fold_over_radius;
  subjects.quat_exp = quat_exp;
  subjects.quat_log = quat_log;
  subjects.parse_trace = [](const std::string& text, const std::string& name) {
    return sim::parse_trace(text, name);
  };
  subjects.pose_at = [](const sim::PoseTrace& trace, SimTime time, sim::Interpolation interpolation) {
    return trace.at(time, interpolation);
  };
  subjects.vsync_time = [](const sim::VsyncClock& clock, std::int64_t index) { return clock.time_of(index); };
  subjects.ssim = [](const ImageRgba8& a, const ImageRgba8& b) { return ssim(a, b); };
  add_stereo(subjects);
  add_load_control(subjects);
  subjects.data_folder = data_folder;
  return subjects;
}

const std::vector<VerifyGroup>& verify_groups() {
  static const std::vector<VerifyGroup> groups = {
      {"integrators", "cast/dvr on this device against exact solutions of the volume rendering integral",
       verify_integrators},
      {"adaptive", "Adaptive steps against very small fixed ones", verify_adaptive},
      {"stability",
       "What becomes of a ray at κΔt from 1e-12 to 1e12; the first three rules are there to see the others' "
       "worth",
       verify_stability},
      {"absorption",
       "Accumulators, Beer–Lambert conversions, opacity correction, transfer function integrals",
       verify_absorption},
      {"skipping", "Empty-space skipping changes no bit of a picture", verify_skipping},
      {"extremes", "Stiff and extreme scenes through every integrator and skip stage", verify_extremes},
      {"lenses", "Lens models of all device profiles", verify_lenses},
      {"motion", "Quaternions, head traces, vsync times, image error", verify_motion},
      {"stereo", "Single-pass stereo: layers, near plane, and the second eye of a slab", verify_stereo},
      {"control",
       "Load controllers over load steps, against adversaries and at the ends of what can be measured",
       verify_control},
      {"schedule", "Cells of an eye frame under a clock guard, over adversarial costs", verify_schedule},
  };
  return groups;
}

}  // namespace brace
