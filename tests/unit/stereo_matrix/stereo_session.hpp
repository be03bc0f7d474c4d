#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "runtime/host/stage_registry.hpp"
#include "runtime/session/session.hpp"

// Sessions for tests of stereo stages within one process.
namespace brace::test {

inline const std::filesystem::path data = BRACE_DATA_FOLDER;

inline const StageRegistry& stage_registry() {
  static const StageRegistry made = [] {
    StageRegistry all;
    all.add_folder(data / "stages");
    return all;
  }();
  return made;
}

/// With the defaults of its parameters.
inline PipelineStage stage_named(const std::string& family, const std::string& name) {
  PipelineStage chosen{stage_registry().find(family, name, "test"), {}};
  for (const StageParameter& parameter : chosen.stage.parameters)
    chosen.values.push_back(parameter.default_value);
  return chosen;
}

/// Vessels before a Vive of 24 px across, cast by cast/dvr; `pipeline` names the stages of other families.
inline Session stereo_session(const std::map<std::string, std::string>& pipeline) {
  Session session;
  session.device = {.profile = "htc-vive",
                    .resolution_scale = 24.0 / 1080.0,
                    .render_target = "panel",
                    .lens = "none",
                    .tracker = "ideal"};
  session.scene.volume = "generator:fractal_vessels:24";
  session.scene.transfer_function = "ct-soft-tissue";
  session.scene.shading = "none";
  session.scene.size_m = 0.6;
  session.scene.position = "front:0.8";
  session.scene.up = "+y";
  session.scene.front = "+z";
  session.scene.nan = "reject";
  session.scene.data_path = "auto";
  session.pipeline["cast"] = stage_named("cast", "dvr");
  for (const auto& [family, name] : pipeline)
    session.pipeline[family] = stage_named(family, name);
  return session;
}

}  // namespace brace::test
