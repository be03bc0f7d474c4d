#include "runtime/session/plan_keys.hpp"

#include <algorithm>
#include <optional>
#include <sstream>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/session/mab_level_items.hpp"

namespace brace {

namespace {

/// How a session does without an item.
struct Without {
  std::string item;
  std::string key;        // "" for a parameter of a stage
  std::string family;     // of the stage with the parameter
  std::string parameter;  // of the stage
  std::string value;      // of key or parameter: TOML
};

const std::vector<Without>& withouts() {
  static const std::vector<Without> all = {
      {"shading", "scene.shading", "", "", "'none'"},
      {"preintegration", "", "cast", "integrator", "'midpoint-exponential'"},
      {"early_termination", "", "cast", "termination_opacity", "1.0"},
      {"skip", "pipeline.skip", "", "", "'none'"},
      {"stereo", "pipeline.stereo", "", "", "'two_pass'"},
      {"rays", "pipeline.rays", "", "", "'full_rate'"},
      {"warp", "pipeline.warp", "", "", "'none'"},
      {"distortion", "", "", "", ""},
      {"chromatic_channels", "", "", "", ""},
      {"scan_out_correction", "", "warp", "scan_out", "'middle'"},
  };
  return all;
}

bool contains(const std::vector<std::string>& list, const std::string& one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

std::vector<std::string> words_of(const SessionTable& table, const char* key,
                                  const std::vector<std::string>& accepted) {
  std::vector<std::string> words;
  const auto given = table.optional_text(key);
  if (!given) return words;
  if (given->empty())
    table.fail(key, fmt::format("is empty; accepted: {}, joined by commas", join(accepted)));
  std::istringstream stream(*given);
  for (std::string word; std::getline(stream, word, ',');) {
    if (!contains(accepted, word))
      table.fail(
          key, fmt::format("names '{}'{}; accepted: {}", word, did_you_mean(word, accepted), join(accepted)));
    if (!contains(words, word)) words.push_back(word);
  }
  return words;
}

const StageParameter* find_parameter(const StageInfo& stage, const std::string& name) {
  for (const StageParameter& parameter : stage.parameters)
    if (parameter.name == name) return &parameter;
  return nullptr;
}

/// The stage has it, and if it is a choice, with the choice that is the item.
bool has_parameter(const StageInfo& stage, const std::string& name) {
  const StageParameter* found = find_parameter(stage, name);
  if (found == nullptr) return false;
  if (name == "integrator") return contains(found->choices, "pre-integrated");
  return name != "scan_out" || contains(found->choices, "lines");
}

/// The choice of a parameter of the cast stage, as the table has it before it is checked.
std::string choice_given(const SessionTable& table, const StageInfo& cast, const std::string& parameter) {
  std::string choice;
  for (const std::string& name : {cast.name, cast.id()}) {
    const auto given = table.node("stage") == nullptr
                           ? std::nullopt
                           : (*table.node("stage")->as_table())[name][parameter].value<std::string>();
    if (given) choice = *given;
  }
  return choice;
}

void take_out(SessionTable& table, const StageRegistry& stages, const Without& without) {
  if (!without.key.empty()) table.put(without.key, without.value);
  if (without.parameter.empty()) return;
  const std::string key = "pipeline." + without.family;
  const StageInfo& stage = stages.find(without.family, table.text(key), table.place(key) + ": '" + key + "'");
  if (!has_parameter(stage, without.parameter)) return;
  // Other integrators than this one stay what they are.
  if (without.item == "preintegration" && choice_given(table, stage, "integrator") != "pre-integrated")
    return;
  table.put_of_stage(stage.id(), without.parameter, without.value);
}

}  // namespace

const std::vector<std::string>& plan_items() {
  static const std::vector<std::string> items = [] {
    std::vector<std::string> names;
    for (const Without& without : withouts()) {
      names.push_back(without.item);
      if (without.item == "rays")
        names.insert(names.end(), mab_level_items().begin(), mab_level_items().end());
    }
    return names;
  }();
  return items;
}

Session::Plan read_plan(SessionTable& table, const StageRegistry& stages) {
  using Mode = Session::Plan::Mode;
  static const std::vector<std::string> modes = {"idle", "auto", "none"};
  std::vector<std::string> accepted = modes;
  accepted.insert(accepted.end(), plan_items().begin(), plan_items().end());
  Session::Plan plan;
  std::optional<Mode> mode;
  for (const std::string& word : words_of(table, "plan.leave_out", accepted)) {
    if (!contains(modes, word)) {
      plan.leave_out.push_back(word);
    } else if (mode) {
      table.fail("plan.leave_out", "names two of idle, auto, none; accepted: one, and items");
    } else {
      mode = word == "idle" ? Mode::idle : word == "auto" ? Mode::automatic : Mode::none;
    }
  }
  plan.mode = mode.value_or(Mode::idle);
  plan.keep = words_of(table, "plan.keep", plan_items());
  for (const std::string& item : plan.keep)
    if (contains(plan.leave_out, item))
      table.fail("plan.keep",
                 fmt::format("names '{}', as does 'plan.leave_out'; accepted: one of the two", item));
  plan.shading = table.choice("scene.shading");
  for (const Without& without : withouts())
    if (contains(plan.leave_out, without.item)) take_out(table, stages, without);
  return plan;
}

bool has_item(const Session& session, const std::string& item) {
  const auto stage = [&](const char* family) { return session.pipeline.at(family).stage.name; };
  const PipelineStage& cast = session.pipeline.at("cast");
  const auto cast_value = [&](const std::string& name) -> std::optional<double> {
    if (!has_parameter(cast.stage, name)) return std::nullopt;
    return cast.value(name);
  };
  if (item == "shading") return session.scene.shading != "none";
  if (item == "preintegration") {
    const auto value = cast_value("integrator");
    return value && find_parameter(cast.stage, "integrator")->choices[static_cast<std::size_t>(*value)] ==
                        "pre-integrated";
  }
  if (item == "early_termination") return cast_value("termination_opacity").value_or(1.0) < 1.0;
  if (item == "skip") return stage("skip") != "none";
  if (item == "stereo") return stage("stereo") != "two_pass";
  if (item == "rays") return stage("rays") != "full_rate";
  if (const auto level = mab_level_of(item))
    return stage("rays") == "mab" && *level < static_cast<int>(session.plan.mab_scales.size());
  if (item == "warp") return stage("warp") != "none";
  if (item == "scan_out_correction") {
    PipelineStage by_line = session.pipeline.at("warp");
    return by_line.set_choice("scan_out", "lines") && by_line.values == session.pipeline.at("warp").values;
  }
  return true;
}

}  // namespace brace
