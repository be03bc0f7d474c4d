#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "base/image.hpp"
#include "base/time.hpp"
#include "hmd_sim/lens.hpp"
#include "hmd_sim/trace_io.hpp"
#include "hmd_sim/vsync.hpp"
#include "runtime/frame/cell_schedule.hpp"
#include "runtime/stereo/scan_line.hpp"
#include "runtime/verify/caster.hpp"
#include "runtime/verify/claim.hpp"
#include "runtime/verify/precision.hpp"
#include "runtime/volume/preintegration.hpp"
#include "stages/control/load_control.hpp"

namespace brace {

/// A load controller: what a frame cost to the quality of a later one.
using QualityUpdate = std::function<double(const stages::FrameLoad&)>;

/// The functions of a CellSchedule.
struct CellFunctions {
  std::function<void()> begin_frame;
  std::function<int()> left;
  std::function<std::optional<CellSchedule::Cell>(SimDuration budget)> next;
  std::function<std::optional<CellSchedule::Cell>()> next_in_any_case;
  std::function<void(const CellSchedule::Cell&)> hand_out;
  std::function<void(const CellSchedule::Cell&, SimDuration cost)> trace;
};

/// What is verified: the product's functions. Checks take them from here, so that a test can hand them a
/// defective one and see its claim fail.
struct VerifySubjects {
  /// Of the device at hand; see device_subjects.
  std::function<CastResult(const CastCase&)> cast;

  std::function<StabilityRun(StabilityRule, Precision, double x)> run_stability;
  std::function<double(Accumulator, Precision, double alpha, int steps)> accumulate;
  std::function<double(double opacity, double length)> kappa_from_opacity;
  std::function<double(double kappa, double length)> opacity_from_kappa;
  std::function<double(double alpha, double rho)> opacity_corrected;
  std::function<TransferIntegrals(const TransferTable&, double step_units)> integrate;

  std::function<double(sim::LensKind, const std::array<double, 5>&, double)> lens_forward;
  std::function<std::optional<double>(sim::LensKind, const std::array<double, 5>&, double, double, int*)>
      lens_inverse;
  std::function<double(sim::LensKind, const std::array<double, 5>&, double)> fold_over_radius;

  std::function<glm::dquat(const glm::dvec3&)> quat_exp;
  std::function<glm::dvec3(const glm::dquat&)> quat_log;
  std::function<sim::TraceReadResult(const std::string&, const std::string&)> parse_trace;
  std::function<Pose(const sim::PoseTrace&, SimTime, sim::Interpolation)> pose_at;
  std::function<SimTime(const sim::VsyncClock&, std::int64_t)> vsync_time;
  std::function<double(const ImageRgba8&, const ImageRgba8&)> ssim;

  std::function<double(const StereoOptics&, double z_near_m, double z_far_m)> disparity_range_px;
  std::function<double(const StereoOptics&, double radius_m, double near_m)> disparity_range_of_sphere_px;
  std::function<double(const StereoOptics&, double radius_m, double disparity_px)> near_plane_m;
  std::function<int(const StereoOptics&, double radius_m, double near_m)> layer_count;
  std::function<int(double range_px, double pixels_per_ray)> interference_free_layers;
  std::function<std::vector<glm::dvec4>(const StereoGeometry&, const ScanRow&, int width_px,
                                        const PathLengths&)>
      compose_scan_line;

  std::function<bool(double gamma_p, double gamma_i, std::uint32_t delay_frames)> pi_control_is_stable;
  std::function<QualityUpdate()> pi_control, window_control;  // new ones, with their defaults
  std::function<QualityUpdate(bool proportional_cut)> quantile_control;
  std::function<CellFunctions(const ChunkedParams&)> cell_schedule;

  std::filesystem::path data_folder;  // share/brace: device profiles
};

/// The product's functions; `cast` runs on `caster`, which must outlive the result.
VerifySubjects product_subjects(Caster& caster, const std::filesystem::path& data_folder);

/// Error over steps, for the page.
struct ErrorCurve {
  std::string problem, rule;
  std::vector<std::array<double, 2>> points;  // samples, error
};

/// Which κΔt a rule survives, for the page: per exponent the largest error; infinity where it left the
/// bounds.
struct StabilityRow {
  std::string rule, precision;
  std::vector<double> errors;  // of x = 10^-12 … 10^12
};

/// Pictures of the claims.
struct VerifyFigures {
  std::vector<ErrorCurve> curves;
  std::vector<StabilityRow> stability;
};

struct VerifyGroup {
  std::string name;   // "integrators"
  std::string about;  // one line for the page
  std::function<void(const VerifySubjects&, Claims&, VerifyFigures&)> check;
};

/// In the order of the page.
const std::vector<VerifyGroup>& verify_groups();

// The groups.
void verify_integrators(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_stability(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_absorption(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_adaptive(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_skipping(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_extremes(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_lenses(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_motion(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_stereo(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_control(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);
void verify_schedule(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures);

}  // namespace brace
