#include "runtime/plan/auto_cast.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "runtime/plan/cast_choice.hpp"
#include "runtime/replay/cast_settings.hpp"
#include "runtime/replay/series_work.hpp"
#include "runtime/replay/stage_conflicts.hpp"

namespace brace {

namespace {

CastDecision take_cast(const char* cast, const std::string& reason) {
  return {{{"pipeline.cast", cast}}, fmt::format("{}: {}", cast, reason)};
}

std::string measured_reason(const CastChoice& choice, const std::string& device) {
  return fmt::format("{} by measurement on {}",
                     choice.cast == "native" ? "the faster one" : "cast/native is not clearly faster",
                     device);
}

}  // namespace

CastDecision decide_cast(const SessionReader& read, const StageRegistry& stages,
                         const ReplayOptions& options) {
  const Session session = read({});
  if (!session.cast_is_open) return {};
  if (!needs_device(session)) return take_cast("dvr", "nothing is cast");
  if (session.output.converged_ideal) return take_cast("dvr", "output.ideal = 'converged' is made by it");
  Overrides native = {{"pipeline.cast", "native"}};
  try {
    const StageInfo& stage = stages.find("cast", "native", "pipeline.cast = 'auto'");
    for (const auto& [name, value] : settings_for(session.pipeline.at("cast"), stage))
      native.emplace_back("stage.native." + name, fmt::format("{}", value));
    require_agreement(read(native));
  } catch (const Error& error) {
    return take_cast("dvr", error.what());
  }
  const gpu::Device device({.select = options.gpu});
  if (!device.info().limits.is_software) return take_cast("dvr", "on a GPU");
  gpu::Measurements here;
  const CastChoice choice =
      choose_cast(device, stages, options.data_folder, options.measurements ? *options.measurements : here);
  CastDecision decision = take_cast(choice.cast.c_str(), measured_reason(choice, device.info().name));
  if (choice.cast == "native") decision.settings = native;
  return decision;
}

}  // namespace brace
