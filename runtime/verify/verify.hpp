#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "base/image.hpp"
#include "hmd_sim/lens.hpp"
#include "hmd_sim/trace_io.hpp"
#include "hmd_sim/vsync.hpp"
#include "runtime/verify/caster.hpp"
#include "runtime/verify/claim.hpp"
#include "runtime/verify/precision.hpp"
#include "runtime/volume/preintegration.hpp"

namespace brace {

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

}  // namespace brace
