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

Json lens_json(const SceneFacts& facts) {
  static const char* const channels[] = {"red", "green", "blue"};
  Json json{{"kind", sim::to_string(facts.lenses[0].kind)},
            {"does_nothing", facts.lens_does_nothing},
            {"channels_equal", facts.channels_equal}};
  for (const sim::Eye eye : sim::all_eyes)
    for (std::size_t i = 0; i < 3; ++i)
      json[eye == sim::Eye::left ? "left" : "right"][channels[i]] =
          facts.lenses[static_cast<std::size_t>(eye)].rgb[i].k;
  return json;
}

Json volume_json(const std::optional<VolumeFacts>& volume) {
  if (!volume) return nullptr;
  return {{"occupancy", volume->occupancy},
          {"visible_values", volume->visible_values},
          {"visible_from", volume->visible.min},
          {"visible_to", volume->visible.max},
          {"kappa_dt_min", volume->kappa_dt_min},
          {"kappa_dt_max", volume->kappa_dt_max},
          {"bounding_radius_m", volume->bounding_radius_m}};
}

Json facts_json(const SceneFacts& facts) {
  return {{"volume", volume_json(facts.volume)},
          {"disparity_px", optional_number(facts.disparity_px())},
          {"volume_distance_m", facts.volume_distance_m},
          {"head_deg_s", facts.head_deg_s},
          {"px_per_deg", facts.px_per_deg},
          {"scan_out",
           {{"direction", sim::to_string(facts.scan_direction)},
            {"ms", facts.scan_out_ms},
            {"px", facts.scan_out_px()}}},
          {"lens", lens_json(facts)}};
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
  text += "\n";
  for (const FactLine& fact : fact_lines(plan.facts))
    text += fmt::format("{:<20} {}\n", fact.name, fact.figure);
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
  json["facts"] = facts_json(plan.facts);
  json["leave_out"] = plan.leave_out;
  json["given_ms"] = plan.given_ms;
  json["planned_ms"] = plan.planned_ms;
  json["saving"] = plan.saving();
  json["cost"] = plan.cost;
  if (check != nullptr) json["check"] = check_json(*check);
  return json.dump(2);
}

}  // namespace brace
