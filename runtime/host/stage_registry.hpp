#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plugins/abi/brace_stage.h"

namespace brace {

class PluginLibrary;

/// The kinds of stage a pipeline is made of, in the order data flows. A stage is named family/name
/// everywhere.
const std::vector<std::string>& stage_families();

enum class ParameterType { boolean, integer, floating, choice };

/// A parameter of a stage; its value is a double (a choice is the index into `choices`).
struct StageParameter {
  std::string name;
  ParameterType type = ParameterType::floating;
  std::string unit;  // "" if none
  std::string help;
  double minimum = 0.0;
  double maximum = 0.0;
  double default_value = 0.0;
  std::vector<std::string> choices;
};

/// What the host knows of a stage, built in or plugged in alike.
struct StageInfo {
  std::string family;
  std::string name;
  std::string version;
  std::string help;
  std::vector<StageParameter> parameters;
  /// Data a stage takes and gives, in words of its family. A warp's inputs say what it takes from the pose
  /// latched for it: "rotation", "translation"; without them it shows the eye frame as it is.
  std::vector<std::string> inputs, outputs;
  std::filesystem::path origin;                    // manifest or shared library; empty if compiled in
  std::filesystem::path glsl_source;               // the snippet of a GLSL stage; empty for a native one
  const brace_stage_descriptor* native = nullptr;  // not owned; null for a GLSL stage
  std::shared_ptr<const PluginLibrary> library;    // holds `native` where that comes from a shared library

  std::string id() const { return family + "/" + name; }
};

/// A stage with a value for each of its parameters, in the manifest's order.
struct PipelineStage {
  StageInfo stage;
  std::vector<double> values;

  /// The value of a parameter by name; the parameter must exist.
  double value(std::string_view parameter) const;

  /// False, and nothing done, if the stage has no such parameter; of a choice, if it has no such word.
  bool set(std::string_view parameter, double value);
  bool set_choice(std::string_view parameter, std::string_view choice);
};

/// The stages that sessions can name. Holds no list of its own: whoever makes it adds folders and
/// descriptors.
class StageRegistry {
 public:
  /// Throws input_error naming both origins if family/name is taken.
  void add(StageInfo stage);
  void add(const brace_stage_descriptor& descriptor, const std::filesystem::path& origin);

  /// Adds every FAMILY/NAME/stage.toml below a folder, in sorted order.
  void add_folder(const std::filesystem::path& folder);

  /// Remembers why a plug-in, or one of its stages, is not here. `id`: the stage's, "" if nobody knows.
  void add_missing(std::string id, std::string why) { missing_.emplace_back(std::move(id), std::move(why)); }

  /// Throws input_error that lists the family's stages and the nearest name. `place` starts the message.
  /// Where the stage may be one of those that could not be loaded, device_error says why they are missing.
  const StageInfo& find(std::string_view family, std::string_view name, const std::string& place) const;

  const std::vector<StageInfo>& stages() const { return stages_; }
  std::vector<std::string> names(std::string_view family) const;

 private:
  std::vector<StageInfo> stages_;
  std::vector<std::pair<std::string, std::string>> missing_;  // id and reason
};

/// Reads a manifest (stage.toml). Throws input_error naming file, key and line.
StageInfo read_stage_manifest(const std::filesystem::path& path);

/// The registration of a native stage as the host's own description; throws input_error on a broken one.
StageInfo stage_info(const brace_stage_descriptor& descriptor, const std::filesystem::path& origin);

/// Checks a value from a session against a parameter; the message names range, unit and what is accepted.
void check_parameter_value(const StageInfo& stage, const StageParameter& parameter, double value,
                           const std::string& place);

}  // namespace brace
