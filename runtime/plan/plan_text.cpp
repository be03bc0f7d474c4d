#include "runtime/plan/plan_text.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/suggest.hpp"

namespace brace {

namespace {

using Json = nlohmann::ordered_json;

std::string saving_text(const PlanLine& line) {
  return line.saving_ms ? fmt::format("{:+.3f}", *line.saving_ms) : "-";
}

Json optional_number(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json check_json(const PlanCheck& check) {
  return {{"given_ms", check.given_ms},
          {"planned_ms", check.planned_ms},
          {"saving", check.saving()},
          {"predicted_saving", check.predicted_saving},
          {"given_dssim", optional_number(check.given_dssim)},
          {"planned_dssim", optional_number(check.planned_dssim)},
          {"passed", check.passed()}};
}

}  // namespace

std::string to_text(const Plan& plan) {
  std::size_t stage_width = 5;
  for (const PlanLine& line : plan.lines)
    stage_width = std::max(stage_width, line.stage.size());
  std::string text = fmt::format("{:<20} {:<{}}  {:<9} {:>9}  {}\n", "item", "stage", stage_width, "verdict",
                                 "saves ms", "because");
  for (const PlanLine& line : plan.lines) {
    text += fmt::format("{:<20} {:<{}}  {:<9} {:>9}  {}\n", line.item, line.stage, stage_width,
                        to_string(line.verdict), saving_text(line), line.figure);
  }
  text += fmt::format("\nframe: {:.3f} ms as given, {:.3f} ms as planned: {:.1f} % less ({})\n",
                      plan.given_ms, plan.planned_ms, 100.0 * plan.saving(), plan.cost);
  if (!plan.leave_out.empty())
    text += fmt::format("run it: brace run SESSION --leave-out {}, or --plan\n", join(plan.leave_out, ","));
  return text;
}

std::string to_text(const Plan& plan, const PlanCheck& check) {
  std::string text = to_text(plan);
  text += fmt::format(
      "\ncheck: {:.3f} ms as given, {:.3f} ms as planned: {:.1f} % less, predicted {:.1f} %: {}\n",
      check.given_ms, check.planned_ms, 100.0 * check.saving(), 100.0 * check.predicted_saving,
      check.saving_as_predicted() ? "right" : "WRONG");
  if (check.given_dssim && check.planned_dssim)
    text += fmt::format("check: DSSIM {:.4f} as given, {:.4f} as planned: {}\n", *check.given_dssim,
                        *check.planned_dssim, check.error_held() ? "held" : "WORSE");
  return text;
}

std::string to_json(const Plan& plan, const PlanCheck* check) {
  Json json;
  for (const PlanLine& line : plan.lines) {
    json["items"].push_back({{"item", line.item},
                             {"stage", line.stage},
                             {"verdict", to_string(line.verdict)},
                             {"figure", line.figure},
                             {"saving_ms", optional_number(line.saving_ms)}});
  }
  json["leave_out"] = plan.leave_out;
  json["given_ms"] = plan.given_ms;
  json["planned_ms"] = plan.planned_ms;
  json["saving"] = plan.saving();
  json["cost"] = plan.cost;
  if (check != nullptr) json["check"] = check_json(*check);
  return json.dump(2);
}

}  // namespace brace
