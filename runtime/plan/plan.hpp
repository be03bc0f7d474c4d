#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "runtime/plan/scene_facts.hpp"
#include "runtime/plan/trial.hpp"
#include "runtime/session/session.hpp"

namespace brace {

/// Where doing without shows (docs/planning.md), all measured by `brace bench plan`.
struct PlanThresholds {
  double warp_px = 0.25;         // added by doing without to how far a picture is off, p95
  double scan_out_px = 1.5;      // p95 of how far the head turns while a rolling panel is lit
  double picture_dssim = 0.002;  // added by doing without: about what a quarter of a pixel's offset makes
  double measured_share = 0.16;  // of a frame: savings below are noise where costs are measured
};

enum class PlanVerdict {
  kept,
  left_out,
  idle,   // does nothing here by construction: not in the kernels
  absent  // the session does not have it
};
const char* to_string(PlanVerdict verdict);

/// A row of the plan: an item of plan_items().
struct PlanLine {
  std::string item;
  std::string stage;  // what it is in this session: "skip/distance_map"
  PlanVerdict verdict = PlanVerdict::absent;
  std::string figure;               // what decides: "the picture is off by 3.1 px (p95) without it, …"
  std::optional<double> saving_ms;  // per frame, of doing without in the plan's own pipeline; < 0: it pays
};

struct Plan {
  std::vector<PlanLine> lines;              // in the order of plan_items()
  std::vector<std::string> leave_out;       // for plan.leave_out
  double given_ms = 0.0, planned_ms = 0.0;  // of the simulated GPU per frame, predicted from trials
  std::string cost;                         // that priced them: clock.cost
  SceneFacts facts;                         // what the decisions stand on

  double saving() const { return given_ms > 0.0 ? 1.0 - planned_ms / given_ms : 0.0; }
  /// What is left out and why, for the report.
  std::vector<LeftOut> reasons() const;
};

/// Reads the session with settings on top of those of the user.
using SessionReader = std::function<Session(const Overrides&)>;

/// Decides by short trials what the session does not need (numerics.md, section 9). What plan.keep names
/// stays. Throws brace::Error as replay() does.
Plan make_plan(const SessionReader& read, PlanTrials& trials, const PlanThresholds& thresholds = {});

/// The settings that make `read` give the planned session.
Overrides settings_of(const Plan& plan);

}  // namespace brace
