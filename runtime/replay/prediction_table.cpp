#include "runtime/replay/prediction_table.hpp"

#include <array>

#include "hmd_sim/predictors.hpp"
#include "runtime/replay/stage_instance.hpp"

namespace brace {

ReportTable prediction_table(const Session& session, const HeadTrace& head_trace, const Headset& headset) {
  const NativeStage stage = live_stage(session.pipeline.at("predict"));
  const brace_predict_functions& functions = stage.predict_functions();
  const auto predict = [&](std::span<const brace_tracker_sample> history, SimTime target) {
    brace_pose pose{};
    const brace_result result = functions.predict(
        stage.self(), history.data(), static_cast<std::uint32_t>(history.size()), to_ns(target), &pose);
    if (result != BRACE_OK) {
      throw device_error("{} failed in predict; expected BRACE_OK; found result {} for t = {} ns",
                         stage.place(), static_cast<int>(result), to_ns(target));
    }
    return sim::from_abi(pose);
  };
  const SimDuration period = from_s(headset.profile.refresh.period_s());
  const std::array<SimDuration, 3> horizons = {period, 2 * period, 4 * period};
  sim::Tracker tracker(head_trace.trace, headset.profile.tracker, session.run.seed);
  ReportTable table{
      "Prediction error",
      session.pipeline.at("predict").stage.id() + ", asked once per display period over the whole trace",
      {"horizon ms", "mean deg", "p95 deg", "max deg", "mean mm", "p95 mm", "max mm"},
      {}};
  for (const sim::PredictionError& e :
       sim::prediction_errors(head_trace.trace, tracker, predict, horizons, period)) {
    const auto text = [](double v) { return fmt::format("{:.3f}", v); };
    table.rows.push_back({text(1e3 * to_s(e.horizon)), text(e.angle_deg.mean), text(e.angle_deg.p95),
                          text(e.angle_deg.max), text(e.position_mm.mean), text(e.position_mm.p95),
                          text(e.position_mm.max)});
  }
  return table;
}

}  // namespace brace
