#include "runtime/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/session/gaze_keys.hpp"
#include "runtime/session/mab_level_items.hpp"
#include "runtime/session/plan_keys.hpp"
#include "runtime/session/selection_keys.hpp"
#include "runtime/session/session_paths.hpp"
#include "runtime/session/session_table.hpp"
#include "runtime/session/transfer_keys.hpp"

namespace brace {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Session::Device read_device(const SessionTable& table) {
  Session::Device device;
  device.profile = table.text("device.profile");
  device.resolution_scale = table.number_in("device.resolution_scale", 0.01, 4.0);
  device.render_target = table.choice("device.render_target");
  device.lens = table.choice("device.lens");
  device.tracker = table.choice("device.tracker");
  return device;
}

double neck_number(const SessionTable& table, const char* key, double fallback, double minimum,
                   double maximum) {
  const toml::node* node = table.node(std::string("trace.neck.") + key);
  if (node == nullptr) return fallback;
  const auto value = node->value<double>();
  if (node->is_number() && value && *value >= minimum && *value <= maximum) return *value;
  throw input_error("{}: 'trace.neck.{}' wants a number from {} to {}", place_of(*node, table.file()), key,
                    minimum, maximum);
}

Session::Trace::Neck read_neck(const SessionTable& table) {
  static const std::vector<std::string> motions = {"rotation", "translation", "natural",
                                                   "still",    "spin",        "inspect"};
  const toml::table& neck_table = *table.node("trace.neck")->as_table();
  reject_unknown_keys(neck_table, table.file(), "trace.neck",
                      {"motion", "degrees", "metres", "seconds", "seed"});
  Session::Trace::Neck neck;
  neck.motion = neck_table["motion"].value_or(std::string());
  if (std::find(motions.begin(), motions.end(), neck.motion) == motions.end()) {
    throw input_error("{}: 'trace.neck.motion' is '{}'{}; accepted: {}", place_of(neck_table, table.file()),
                      neck.motion, did_you_mean(neck.motion, motions), join(motions));
  }
  neck.degrees = neck_number(table, "degrees", 60.0, -36000.0, 36000.0);
  neck.metres = neck_number(table, "metres", 0.3, -100.0, 100.0);
  neck.seconds = neck_number(table, "seconds", 1.0, 0.001, 1e6);
  const double seed = neck_number(table, "seed", 1.0, 0.0, 9e15);
  if (seed != std::floor(seed)) table.fail("trace.neck.seed", "wants a whole number");
  neck.seed = static_cast<std::uint64_t>(seed);
  return neck;
}

Session::Trace read_trace(const SessionTable& table, const std::filesystem::path& folder) {
  Session::Trace trace;
  const auto file = table.optional_text("trace.file");
  const bool generated = table.node("trace.neck") != nullptr;
  if (file && generated) table.fail("trace.neck", "stands beside 'trace.file'; accepted: one of the two");
  if (!file && !generated) {
    throw input_error("{}: no head motion: accepted: 'trace.file' or 'trace.neck'", table.file());
  }
  if (file && file->empty()) table.fail("trace.file", "is empty");
  // A bare name is a shipped trace; the replay looks it up.
  if (file) trace.file = is_bare_name(*file) ? std::filesystem::path(*file) : absolute_from(folder, *file);
  if (generated) trace.neck = read_neck(table);
  trace.interpolation = table.choice("trace.interpolation");
  trace.strict = table.flag("trace.strict");
  trace.loop = table.flag("trace.loop");
  trace.start_s = table.number_in("trace.start_s", 0.0, 1e9);
  return trace;
}

void check_position(const SessionTable& table, const std::string& position) {
  const bool front = position.rfind("front:", 0) == 0;
  std::istringstream stream(front ? position.substr(6) : position);
  double value = 0.0;
  char comma = 0;
  const int wanted = front ? 1 : 3;
  int found = 0;
  while (found < wanted && stream >> value && std::isfinite(value)) {
    ++found;
    if (found < wanted && !(stream >> comma && comma == ',')) break;
  }
  std::string rest;
  if (found != wanted || stream >> rest) {
    table.fail("scene.position", fmt::format("is '{}'; accepted: front:D or x,y,z in metres", position));
  }
}

std::array<double, 3> read_light(const SessionTable& table) {
  const std::string text = table.text("scene.light");
  std::array<double, 3> light{};
  std::istringstream stream(text);
  char comma = ',';
  bool fine = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    fine = fine && (axis == 0 || (stream >> comma && comma == ','));
    fine = fine && stream >> light[axis];
  }
  std::string rest;
  const double length = std::hypot(light[0], light[1], light[2]);
  if (!fine || stream >> rest || !(length > 0.0) || !std::isfinite(length))
    table.fail("scene.light", fmt::format("is '{}'; accepted: x,y,z towards the light, not all 0", text));
  return light;
}

Session::Scene read_scene(const SessionTable& table, const std::filesystem::path& folder) {
  Session::Scene scene;
  scene.volume = table.text("scene.volume");
  if (scene.volume.rfind("generator:", 0) != 0) scene.volume = absolute_from(folder, scene.volume).string();
  scene.transfer_function = transfer_function_from(folder, table.text("scene.transfer_function"));
  scene.shading = table.choice("scene.shading");
  scene.shading_samples = static_cast<int>(table.number_in("scene.shading_samples", 0, 64));
  scene.shading_step_voxels = table.number_in("scene.shading_step_voxels", 0.01, 64.0);
  scene.light = read_light(table);
  scene.size_m = table.number_in("scene.size_m", 1e-6, 1e6);
  scene.position = table.text("scene.position");
  check_position(table, scene.position);
  scene.up = table.choice("scene.up");
  scene.front = table.choice("scene.front");
  if (scene.up[1] == scene.front[1])
    table.fail("scene.front", "is the axis that 'scene.up' names; take another");
  scene.window = table.optional_number("scene.window");
  if (scene.window && !(*scene.window > 0.0)) table.fail("scene.window", "wants a width above 0");
  scene.level = table.optional_number("scene.level");
  read_transfer_changes(table, folder, scene);
  if (table.node("scene.table_entries") != nullptr) {
    scene.table_entries = static_cast<int>(table.number_in("scene.table_entries", 256, 4096));
  }
  scene.nan = table.choice("scene.nan");
  scene.data_path = table.choice("scene.data_path");
  return scene;
}

std::vector<Session::Clock::ScriptedSegment> read_script(const SessionTable& table) {
  std::vector<Session::Clock::ScriptedSegment> script;
  const toml::node* node = table.node("clock.script");
  if (node == nullptr) return script;
  for (const auto& entry : *node->as_array()) {
    const toml::table& segment = *entry.as_table();
    reject_unknown_keys(segment, table.file(), "clock.script", {"from_s", "cast_ms", "warp_ms", "update_ms"});
    const auto number = [&](const char* key) {
      const auto value = segment[key].value<double>();
      if (value && *value >= 0.0 && *value < kInfinity) return *value;
      throw input_error("{}: a segment of 'clock.script' wants {} as a number from 0",
                        place_of(entry, table.file()), key);
    };
    script.push_back({number("from_s"), number("cast_ms"), number("warp_ms"),
                      segment.contains("update_ms") ? number("update_ms") : 0.0});
    if (script.size() > 1 && script.back().from_s <= script[script.size() - 2].from_s) {
      throw input_error("{}: segments of 'clock.script' are written in rising from_s",
                        place_of(entry, table.file()));
    }
  }
  return script;
}

void check_cost(const SessionTable& table, std::string& cost, const std::filesystem::path& folder) {
  if (cost == "measured" || cost == "scripted") return;
  if (cost.rfind("model:", 0) == 0 && cost.size() > 6) return;
  if (cost.rfind("stage:", 0) == 0 && cost.size() > 6) return;  // read_pipeline looks it up
  if (cost.rfind("recorded:", 0) == 0 && cost.size() > 9) {
    cost = "recorded:" + absolute_from(folder, cost.substr(9)).string();
    return;
  }
  table.fail(
      "clock.cost",
      fmt::format("is '{}'; accepted: model:NAME, measured, recorded:DIR, scripted, stage:NAME", cost));
}

Session::Clock read_clock(const SessionTable& table, const std::filesystem::path& folder) {
  Session::Clock clock;
  clock.wall = table.choice("clock.mode") == "wall";
  clock.queue = table.choice("clock.queue");
  clock.cost = table.text("clock.cost");
  check_cost(table, clock.cost, folder);
  clock.cost_resolution = table.choice("clock.cost_resolution");
  clock.cost_scale = table.number_in("clock.cost_scale", 1e-6, 1e6);
  if (table.node("clock.warp_lead_ms") != nullptr) {
    clock.warp_lead_ms = table.number_in("clock.warp_lead_ms", 0.0, 1000.0);
  }
  clock.preempt_granularity_us = table.number_in("clock.preempt_granularity_us", 0.0, 1e6);
  clock.switch_cost_us = table.number_in("clock.switch_cost_us", 0.0, 1e6);
  clock.script = read_script(table);
  if (clock.cost == "scripted" && clock.script.empty()) {
    table.fail("clock.cost", "is 'scripted' but there is no [[clock.script]] segment");
  }
  return clock;
}

/// The host's clock has no time for what measures or draws, and one thread that casts and warps.
void check_wall_clock(const SessionTable& table, const Session& session) {
  if (!session.clock.wall) return;
  const auto want = [&](const char* key, const std::string& is, const char* accepted, const char* why) {
    if (is != accepted)
      table.fail(key, fmt::format("is '{}', but clock.mode is 'wall', {}; accepted: {}", is, why, accepted));
  };
  want("clock.cost", session.clock.cost, "measured", "where jobs take what they take");
  want("clock.queue", session.clock.queue, "single", "where one thread casts and warps");
  want("output.error", table.text("output.error"), "none", "whose vsyncs would wait for it");
  want("output.images", table.text("output.images"), "none", "whose vsyncs would wait for them");
}

/// The parameters of a stage from [stage."name"] or [stage."family/name"], defaults where there are none.
std::vector<double> stage_values(const SessionTable& table, const StageInfo& stage) {
  std::vector<double> values;
  for (const StageParameter& parameter : stage.parameters)
    values.push_back(parameter.default_value);
  const toml::table* all = table.node("stage") == nullptr ? nullptr : table.node("stage")->as_table();
  if (all == nullptr) return values;
  for (const std::string& name : {stage.name, stage.id()}) {
    const toml::node* node = all->get(name);
    if (node == nullptr) continue;
    if (!node->is_table())
      throw input_error("{}: [stage.\"{}\"] is a table", place_of(*node, table.file()), name);
    std::vector<std::string> known;
    for (const StageParameter& parameter : stage.parameters)
      known.push_back(parameter.name);
    reject_unknown_keys(*node->as_table(), table.file(), "stage." + name, known);
    for (std::size_t i = 0; i < stage.parameters.size(); ++i) {
      const StageParameter& parameter = stage.parameters[i];
      const toml::node* given = node->as_table()->get(parameter.name);
      if (given == nullptr) continue;
      const std::string place = place_of(*given, table.file());
      if (parameter.type == ParameterType::choice) {
        const std::string text = given->value_or(std::string());
        const auto at = std::find(parameter.choices.begin(), parameter.choices.end(), text);
        if (at == parameter.choices.end()) {
          throw input_error("{}: {} of stage {} is '{}'{}; accepted: {}", place, parameter.name, stage.id(),
                            text, did_you_mean(text, parameter.choices), join(parameter.choices));
        }
        values[i] = static_cast<double>(at - parameter.choices.begin());
        continue;
      }
      if (!(given->is_number() || (given->is_boolean() && parameter.type == ParameterType::boolean))) {
        throw input_error("{}: {} of stage {} wants a {}", place, parameter.name, stage.id(),
                          parameter.type == ParameterType::boolean ? "true or false" : "number");
      }
      values[i] = given->is_boolean() ? (given->value_or(false) ? 1.0 : 0.0)
                                      : given->value<double>().value_or(std::nan(""));
      check_parameter_value(stage, parameter, values[i], place);
    }
  }
  return values;
}

std::map<std::string, PipelineStage> read_pipeline(const SessionTable& table, const StageRegistry& stages) {
  std::map<std::string, PipelineStage> pipeline;
  std::vector<std::string> used;
  for (const std::string& family : stage_families()) {
    const std::string key = family == "cost" ? "clock.cost" : "pipeline." + family;
    std::string name = table.text(key);
    if (family == "cost") {
      if (name.rfind("stage:", 0) != 0) continue;
      name = name.substr(6);
    }
    const StageInfo& stage = stages.find(family, name, table.place(key) + ": '" + key + "'");
    pipeline[family] = {stage, stage_values(table, stage)};
    used.push_back(stage.name);
    used.push_back(stage.id());
  }
  const toml::node* settings = table.node("stage");
  if (settings == nullptr) return pipeline;
  for (const auto& [name, node] : *settings->as_table()) {
    const std::string stage(name.str());
    if (std::find(used.begin(), used.end(), stage) != used.end()) continue;
    std::vector<std::string> known, parameters;
    for (const StageInfo& info : stages.stages()) {
      known.push_back(info.name), known.push_back(info.id());
      if (info.name != stage && info.id() != stage) continue;
      for (const StageParameter& parameter : info.parameters)
        parameters.push_back(parameter.name);
    }
    // Settings of a stage that this pipeline leaves out are fine, sessions switch stages with --set; but they
    // are settings that it has.
    if (std::find(known.begin(), known.end(), stage) != known.end()) {
      if (!node.is_table())
        throw input_error("{}: [stage.\"{}\"] is a table", place_of(node, table.file()), stage);
      reject_unknown_keys(*node.as_table(), table.file(), "stage." + stage, parameters);
      continue;
    }
    throw input_error("{}: [stage.\"{}\"] names no stage{}; used here: {}", place_of(node, table.file()),
                      stage, did_you_mean(stage, known), join(used));
  }
  return pipeline;
}

/// A value of TOML as --set takes it.
std::string setting_text(const toml::node& value) {
  if (const auto plain = value.value<std::string>(); plain && value.is_string()) return *plain;
  std::ostringstream text;
  value.visit([&](const auto& concrete) { text << concrete; });
  return text.str();
}

std::vector<Session::Case> cases_of_values(const SessionTable& table, const std::string& key,
                                           const toml::array& values) {
  std::vector<Session::Case> cases;
  for (const auto& value : values) {
    const std::string text = setting_text(value);
    if (text.empty()) table.fail("compare.values", "holds an empty value");
    cases.push_back({text, {{key, text}}});
  }
  return cases;
}

/// [[compare.case]]: a label and a table of keys to set.
Session::Case read_case(const SessionTable& table, const toml::table& entry) {
  Session::Case result;
  for (const auto& [name, node] : entry) {
    if (name.str() == "label" && node.is_string()) {
      result.label = setting_text(node);
    } else if (name.str() == "set" && node.is_table()) {
      for (const auto& [key, value] : *node.as_table())
        result.settings.emplace_back(key.str(), setting_text(value));
    } else {
      throw input_error(
          "{}: compare.case: '{}' is none of its keys, or of another type; accepted: label (text), set "
          "(table of KEY = VALUE)",
          place_of(node, table.file()), name.str());
    }
  }
  if (result.label.empty()) table.fail("compare.case", "wants a label in every entry");
  return result;
}

std::vector<Session::Case> read_compare(const SessionTable& table) {
  const auto key = table.optional_text("compare.key");
  const toml::node* values = table.node("compare.values");
  const toml::node* entries = table.node("compare.case");
  if (!key && values == nullptr && entries == nullptr) return {};
  if (entries != nullptr && (key || values != nullptr))
    throw input_error("{}: [compare] wants either 'key' and 'values', or 'case'", table.file());
  if (entries == nullptr && (!key || values == nullptr))
    throw input_error("{}: [compare] wants both 'key' and 'values'", table.file());

  const char* place = entries != nullptr ? "compare.case" : "compare.values";
  std::vector<Session::Case> cases;
  if (entries == nullptr) {
    cases = cases_of_values(table, *key, *values->as_array());
  } else {
    for (const auto& entry : *entries->as_array())
      cases.push_back(read_case(table, *entry.as_table()));
  }
  if (cases.size() < 2) table.fail(place, "wants at least two values");
  for (auto one = cases.begin(); one != cases.end(); ++one) {
    const auto same = [&](const Session::Case& other) { return other.label == one->label; };
    if (std::any_of(cases.begin(), one, same)) table.fail(place, fmt::format("names '{}' twice", one->label));
    for (const auto& [set_key, ignored] : one->settings) {
      if (set_key.rfind("compare.", 0) == 0)
        table.fail(entries != nullptr ? place : "compare.key", "cannot be a key of [compare] itself");
    }
  }
  return cases;
}

/// What pipeline.skip = "auto" chooses from.
std::vector<PipelineStage> read_skip_candidates(const SessionTable& table, const StageRegistry& stages) {
  std::vector<PipelineStage> candidates;
  for (const StageInfo& stage : stages.stages()) {
    if (stage.family == "skip" && stage.name != "auto" && stage.native == nullptr)
      candidates.push_back({stage, stage_values(table, stage)});
  }
  return candidates;
}

void write_absolute_paths(SessionTable& table, const Session& session) {
  const auto put = [&](const char* section, const char* key, const std::string& value) {
    table.table()[section].as_table()->insert_or_assign(key, value);
  };
  if (!session.trace.file.empty()) put("trace", "file", session.trace.file.string());
  put("scene", "volume", session.scene.volume);
  put("scene", "transfer_function", session.scene.transfer_function);
  write_absolute_transfer_changes(table, session.scene);
  put("clock", "cost", session.clock.cost);
}

/// Every parameter of the pipeline's stages under [stage."family/name"], as used.
void write_stage_values(SessionTable& table, const Session& session) {
  toml::table& settings = *table.table().insert("stage", toml::table()).first->second.as_table();
  for (const auto& [family, chosen] : session.pipeline)
    settings.erase(chosen.stage.name);
  for (const auto& [family, chosen] : session.pipeline) {
    toml::table values;
    for (std::size_t i = 0; i < chosen.values.size(); ++i) {
      const StageParameter& parameter = chosen.stage.parameters[i];
      const double value = chosen.values[i];
      switch (parameter.type) {
        case ParameterType::boolean:
          values.insert(parameter.name, value != 0.0);
          break;
        case ParameterType::integer:
          values.insert(parameter.name, static_cast<std::int64_t>(value));
          break;
        case ParameterType::floating:
          values.insert(parameter.name, value);
          break;
        case ParameterType::choice:
          values.insert(parameter.name, parameter.choices[static_cast<std::size_t>(value)]);
          break;
      }
    }
    if (!values.empty()) settings.insert_or_assign(chosen.stage.id(), std::move(values));
  }
}

}  // namespace

bool Session::Plan::keeps_idle(const std::string& item) const {
  return mode == Mode::none || std::find(keep.begin(), keep.end(), item) != keep.end();
}

Session parse_session(const std::string& text, const std::string& file_name,
                      const std::filesystem::path& folder, const Overrides& overrides,
                      const StageRegistry& stages) {
  SessionTable table(parse_toml(text, file_name), file_name);
  for (const auto& [key, value] : overrides)
    table.set(key, value);
  table.check_and_complete();

  Session session;
  session.plan = read_plan(table, stages);
  session.file = file_name;
  session.name = std::filesystem::path(file_name).stem().string();
  session.device = read_device(table);
  session.trace = read_trace(table, folder);
  session.gaze = read_gaze(table);
  session.scene = read_scene(table, folder);
  session.clock = read_clock(table, folder);
  session.cast_is_open = table.text("pipeline.cast") == "auto";
  if (session.cast_is_open) table.set("pipeline.cast", "dvr");
  session.pipeline = read_pipeline(table, stages);
  if (session.pipeline.at("skip").stage.name == "auto")
    session.skip_candidates = read_skip_candidates(table, stages);
  for (const StageInfo& stage : stages.stages()) {
    if (stage.id() == "rays/full_rate") session.full_rate = {stage, stage_values(table, stage)};
    if (stage.id() == "cast/native") session.native_cast = {stage, stage_values(table, stage)};
  }
  session.output.images = read_selection(table, "output.images");
  session.output.error = read_selection(table, "output.error");
  session.output.converged_ideal = table.choice("output.ideal") == "converged";
  session.output.native_ideal = table.choice("output.ideal_cast") == "native";
  session.output.ideal_by_line = table.choice("output.ideal_pose") == "lines";
  if (table.node("run.frames") != nullptr) {
    session.run.frames = static_cast<std::int64_t>(table.number_in("run.frames", 1, 1e12));
  }
  if (table.integer("run.seed") < 0) table.fail("run.seed", "is negative; accepted: 0 to 2^63-1");
  session.run.seed = static_cast<std::uint64_t>(table.integer("run.seed"));
  session.run.watchdog = parse_watchdog_level(table.choice("run.watchdog"));
  if (table.node("run.deadline_ms") != nullptr)
    session.run.deadline_ms = table.number_in("run.deadline_ms", 0.001, 1e6);
  session.compare = read_compare(table);
  check_wall_clock(table, session);

  write_absolute_paths(table, session);
  write_stage_values(table, session);
  std::ostringstream resolved;
  resolved << table.table() << "\n";
  session.resolved_toml = resolved.str();
  // After it was written: read back, it names the levels to leave out beside all that there were.
  session.plan.mab_scales = mab_scales(session.pipeline.at("rays"));
  take_out_mab_levels(session.pipeline.at("rays"), session.plan.leave_out);
  return session;
}

Session read_session(const std::filesystem::path& file, const Overrides& overrides,
                     const StageRegistry& stages) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw input_error("{}: is a folder; a session is a TOML file", file.string());
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw input_error("{}: cannot be opened: no such session file", file.string());
  std::ostringstream text;
  text << stream.rdbuf();
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  return parse_session(text.str(), file.string(), folder, overrides, stages);
}

}  // namespace brace
