#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runtime/host/stage_registry.hpp"
#include "tools/live/overlay.hpp"

namespace brace {

/// One setting of the session, as --set takes it.
struct Setting {
  std::string key, value;
};

/// Switches for every stage of the session and its parameters, with units and ranges from the manifests.
class StagePanel {
 public:
  /// Puts the widgets into the panel that is open. `notes` are shown below their family.
  /// Returns what has been chosen, once per choice: a slider counts when it is let go.
  std::optional<Setting> show(Overlay& overlay, const std::map<std::string, PipelineStage>& pipeline,
                              const std::vector<StageInfo>& stages,
                              const std::map<std::string, std::string>& notes);

 private:
  std::optional<Setting> show_parameter(Overlay& overlay, const PipelineStage& chosen, std::size_t index);

  std::string edited_;  // key of the slider being moved
  double value_ = 0.0;  // where it is
};

/// "voxels, 0.01 to 64" of a number, "true or false" of a flag, the words of a choice.
std::string accepted_of(const StageParameter& parameter);

/// A parameter's value as a session file has it.
std::string value_text(const StageParameter& parameter, double value);

}  // namespace brace
