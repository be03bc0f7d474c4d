#include "runtime/verify/verify.hpp"

#include "runtime/metrics/image_error.hpp"

namespace brace {

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
  };
  return groups;
}

}  // namespace brace
