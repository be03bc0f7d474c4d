#include "runtime/plan/plan_rules.hpp"

#include <fmt/format.h>

#include "runtime/session/mab_level_items.hpp"
#include "runtime/session/plan_keys.hpp"

namespace brace {

const std::vector<std::string>& tried_items() {
  static const std::vector<std::string> items = [] {
    std::vector<std::string> names = {"warp",   "shading", "preintegration", "early_termination",
                                      "stereo", "rays"};
    names.insert(names.end(), mab_level_items().begin(), mab_level_items().end());
    names.insert(names.end(), {"skip", "scan_out_correction"});
    return names;
  }();
  return items;
}

std::string stage_text(const Session& session, const std::string& item) {
  if (item == "shading") return session.scene.shading;
  if (session.pipeline.contains(item)) return session.pipeline.at(item).stage.id();
  if (!has_item(session, item)) return "-";
  if (item == "scan_out_correction") return session.pipeline.at("warp").stage.id() + " by line";
  if (const auto level = mab_level_of(item))
    return fmt::format("rays/mab at {:g}", session.plan.mab_scales[static_cast<std::size_t>(*level)]);
  const PipelineStage& cast = session.pipeline.at("cast");
  if (item == "preintegration") return cast.stage.id();
  if (item == "early_termination")
    return fmt::format("{} at {:g}", cast.stage.id(), cast.value("termination_opacity"));
  return "display";
}

std::string PlanRules::fact_behind(const std::string& item) const {
  if (!facts_.volume) return "";
  if (item == "skip") return fmt::format("occupancy {:.3f}", facts_.volume->occupancy);
  if (item == "preintegration") return fmt::format("kappa dt up to {:.3g}", facts_.volume->kappa_dt_max);
  if (item == "stereo") return fmt::format("disparity {:.2f} px", *facts_.disparity_px());
  return "";
}

ErrorVerdict PlanRules::warp_error(const Session& whole, const Session& without, PlanTrials& trials) const {
  const auto off_px = [&](const Session& session) {
    const PlanTrial trial = trials.replay_briefly(session);
    return facts_.off_px(trial.angular_error_deg, trial.position_error_mm);
  };
  const double with_it = off_px(whole), without_it = off_px(without);
  return {without_it - with_it <= thresholds_.warp_px,
          fmt::format("the picture is off by {:.2f} px (p95) without it, {:.2f} with, limit +{:g}",
                      without_it, with_it, thresholds_.warp_px)};
}

/// Not what changes counts but what is wrong: often the plain rule is nearer to converged steps.
ErrorVerdict PlanRules::integrator_error(const Session& whole, const Session& without,
                                         PlanTrials& trials) const {
  const std::optional<double> with_it = trials.picture_error(whole),
                              without_it = trials.picture_error(without);
  if (!with_it || !without_it) return {};
  return {*without_it <= *with_it + thresholds_.picture_dssim,
          fmt::format("against converged steps DSSIM {:.4f} without it, {:.4f} with, limit +{:g}",
                      *without_it, *with_it, thresholds_.picture_dssim)};
}

ErrorVerdict PlanRules::error_without(const std::string& item, const Session& whole, const Session& without,
                                      PlanTrials& trials) const {
  if (item == "warp") return warp_error(whole, without, trials);
  if (item == "scan_out_correction")
    return {facts_.scan_out_px() <= thresholds_.scan_out_px,
            fmt::format("the view moves by {:.2f} px (p95) in a scan-out, limit {:g}", facts_.scan_out_px(),
                        thresholds_.scan_out_px)};
  if (item == "preintegration") return integrator_error(whole, without, trials);
  if (item != "shading" && !mab_level_of(item)) return {};
  const std::optional<double> change = trials.picture_change(whole, without);
  if (!change) return {};
  return {*change <= thresholds_.picture_dssim,
          fmt::format("without it pictures change by DSSIM {:.4f}, limit {:g}", *change,
                      thresholds_.picture_dssim)};
}

double PlanRules::least_saving_ms(const PlanTrial& trial) const {
  return trial.deterministic ? 0.0 : thresholds_.measured_share * trial.frame_ms;
}

void PlanRules::judge_display(const Session& given, PlanLine& line) const {
  const bool distortion = line.item == "distortion";
  const bool idle = distortion ? facts_.lens_does_nothing : facts_.channels_equal;
  line.verdict = !idle || given.plan.keeps_idle(line.item) ? PlanVerdict::kept : PlanVerdict::idle;
  line.figure = distortion
                    ? (idle ? "the lens polynomial is 1" : "the lens bends the picture")
                    : (idle ? "the channels' polynomials are equal: one fetch" : "a polynomial per channel");
}

}  // namespace brace
