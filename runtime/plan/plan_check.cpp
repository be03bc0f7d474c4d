#include "runtime/plan/plan_check.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "base/error.hpp"

namespace brace {

namespace {

std::optional<double> mean_dssim(const nlohmann::json& series) {
  const nlohmann::json& mean = series["dssim"]["mean"];
  return mean.is_number() ? std::optional(mean.get<double>()) : std::nullopt;
}

double frame_ms(const nlohmann::json& series) {
  return series.contains("gpu_ms") ? series["gpu_ms"]["frame"].get<double>() : 0.0;
}

}  // namespace

bool PlanCheck::saving_as_predicted() const {
  return std::abs(saving() - predicted_saving) <= check_saving_tolerance;
}

bool PlanCheck::error_held() const {
  return !given_dssim || !planned_dssim || *planned_dssim - *given_dssim <= check_dssim_tolerance;
}

PlanCheck check_plan(const Plan& plan, const SessionReader& read, const ReplayOptions& options,
                     const std::filesystem::path& destination) {
  const ReplayOutcome outcome = replay(
      {{"given", read({}), {}}, {"planned", read(settings_of(plan)), plan.reasons()}}, options, destination);
  if (!outcome.failure.empty()) throw device_error("{}", outcome.failure);
  const auto summary = nlohmann::json::parse(outcome.summary_json);
  const nlohmann::json& given = summary["series"][0];
  const nlohmann::json& planned = summary["series"][1];
  return {frame_ms(given), frame_ms(planned), mean_dssim(given), mean_dssim(planned), plan.saving()};
}

}  // namespace brace
