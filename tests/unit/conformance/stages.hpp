#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "plugins/examples/broken/broken_stages.h"
#include "runtime/host/plugin_library.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

inline StageInfo stage_from(const std::filesystem::path& file, const std::string& family,
                            const std::string& name) {
  StageRegistry registry;
  add_plugins(registry, {.given = {file}, .ambient = {}, .installed = {}});
  return registry.find(family, name, "test");
}

inline StageInfo example_stage(const std::string& library, const std::string& family,
                               const std::string& name) {
  return stage_from(std::filesystem::path(EXAMPLE_PLUGINS) / library, family, name);
}

/// A stage of the broken library that breaks one rule as it is, without a session saying so.
inline StageInfo broken_stage(const std::string& family, int defect) {
  StageInfo stage = stage_from(std::filesystem::path(BROKEN_PLUGINS) / "broken_stages.so", family, "broken");
  stage.parameters[0].default_value = defect;
  return stage;
}

inline PipelineStage with_defaults(const StageInfo& stage) {
  PipelineStage chosen{stage, {}};
  for (const StageParameter& parameter : stage.parameters)
    chosen.values.push_back(parameter.default_value);
  return chosen;
}

}  // namespace brace
