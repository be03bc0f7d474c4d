#include "runtime/replay/cast_integrator.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace brace {

namespace {

const StageParameter* find(const PipelineStage& cast, std::string_view name) {
  const auto& parameters = cast.stage.parameters;
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const StageParameter& parameter) { return parameter.name == name; });
  return found == parameters.end() ? nullptr : &*found;
}

bool is_chosen(const PipelineStage& cast, std::string_view parameter, std::string_view choice) {
  const StageParameter* found = find(cast, parameter);
  if (found == nullptr || found->type != ParameterType::choice) return false;
  return found->choices[static_cast<std::size_t>(cast.value(parameter))] == choice;
}

bool is_adaptive(const PipelineStage& cast) {
  return find(cast, "tolerance") != nullptr && cast.value("tolerance") > 0.0;
}

}  // namespace

bool wants_levels(const PipelineStage& cast) {
  return find(cast, "lod") != nullptr && !is_chosen(cast, "lod", "off");
}

TransferExtras transfer_extras(const PipelineStage& cast) {
  const bool adaptive = is_adaptive(cast);
  if (adaptive && is_chosen(cast, "integrator", "left")) {
    throw input_error(
        "stage {}: integrator = \"left\" has no error estimate, so tolerance = {} cannot be kept; accepted "
        "with a "
        "tolerance: linear-source, pre-integrated, or the default",
        cast.stage.id(), cast.value("tolerance"));
  }
  if (adaptive && find(cast, "step_voxels_min") != nullptr &&
      cast.value("step_voxels_min") > cast.value("step_voxels_max")) {
    throw input_error("stage {}: step_voxels_min = {} exceeds step_voxels_max = {}", cast.stage.id(),
                      cast.value("step_voxels_min"), cast.value("step_voxels_max"));
  }
  if (wants_levels(cast) && (adaptive || !is_chosen(cast, "integrator", "midpoint-exponential"))) {
    throw input_error(
        "stage {}: a level of detail has steps of its own and one sample in the middle of each; accepted "
        "with "
        "lod: tolerance = 0 and integrator = \"midpoint-exponential\"; or lod = \"off\"",
        cast.stage.id());
  }
  TransferExtras extras;
  extras.integrals = is_chosen(cast, "integrator", "pre-integrated");
  extras.segments = extras.integrals && !adaptive && is_chosen(cast, "preintegration", "table");
  return extras;
}

std::optional<Session> converged_session(const Session& session) {
  if (session.pipeline.at("cast").stage.id() != "cast/dvr") return std::nullopt;
  Session converged = session;
  PipelineStage& cast = converged.pipeline.at("cast");
  cast.set("step_voxels", cast.value("step_voxels") / 4.0);
  cast.set_choice("integrator", "pre-integrated");
  cast.set("tolerance", 0.0);
  cast.set_choice("lod", "off");
  return converged;
}

}  // namespace brace
