#pragma once

#include <filesystem>
#include <optional>

#include "runtime/plan/plan.hpp"

namespace brace {

/// How far a plan may be from what both runs show.
inline constexpr double check_saving_tolerance = 0.03;  // of the frame's time
inline constexpr double check_dssim_tolerance = 0.002;

/// The session as given and as planned, both replayed in full.
struct PlanCheck {
  double given_ms = 0.0, planned_ms = 0.0;           // per frame
  std::optional<double> given_dssim, planned_dssim;  // means; empty where no error was measured
  double predicted_saving = 0.0;

  double saving() const { return given_ms > 0.0 ? 1.0 - planned_ms / given_ms : 0.0; }
  bool saving_as_predicted() const;
  bool error_held() const;
  bool passed() const { return saving_as_predicted() && error_held(); }
};

/// Writes one run directory with both, labelled "given" and "planned". Throws as replay() does.
PlanCheck check_plan(const Plan& plan, const SessionReader& read, const ReplayOptions& options,
                     const std::filesystem::path& destination);

}  // namespace brace
