#pragma once

#include <string>

#include "runtime/plan/plan.hpp"
#include "runtime/plan/plan_check.hpp"

namespace brace {

/// Like a database's EXPLAIN: a line per item, what became of it, the figure behind that, what it costs; then
/// what the scene is like.
std::string to_text(const Plan& plan);

/// {"items": [{"item", "stage", "verdict", "figure", "saving_ms"}], "leave_out", "given_ms", "planned_ms",
/// "saving", "cost", "facts": {"volume": {"occupancy", …}, "disparity_px", "scan_out", "lens", …}}; with a
/// check also "check": {"given_ms", …, "passed"}.
std::string to_json(const Plan& plan, const PlanCheck* check = nullptr);

std::string to_text(const Plan& plan, const PlanCheck& check);

}  // namespace brace
