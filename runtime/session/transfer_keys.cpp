#include "runtime/session/transfer_keys.hpp"

#include <cmath>

#include "base/error.hpp"
#include "runtime/session/session_paths.hpp"

namespace brace {

namespace {

using TransferChange = Session::Scene::TransferChange;
using TransferAnimation = Session::Scene::TransferAnimation;

std::optional<double> finite_number(const toml::table& table, const char* key, const std::string& what,
                                    const std::string& file) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value<double>();
  if (node->is_number() && value && std::isfinite(*value)) return value;
  throw input_error("{}: '{}' of {} wants a finite number", place_of(*node, file), key, what);
}

TransferChange read_change(const toml::table& entry, const std::filesystem::path& folder,
                           const std::string& file) {
  const std::string what = "'scene.transfer_change'";
  reject_unknown_keys(entry, file, "scene.transfer_change", {"at_s", "transfer_function", "window", "level"});
  const std::string place = place_of(entry, file);
  const std::optional<double> at_s = finite_number(entry, "at_s", what, file);
  if (!at_s || !(*at_s > 0.0 && *at_s <= 1e9)) {
    throw input_error(
        "{}: an entry of {} wants at_s, seconds of run time above 0 and up to 1e9 (from 0 on the "
        "scene's own transfer function is in force)",
        place, what);
  }
  TransferChange change;
  change.at_s = *at_s;
  change.window = finite_number(entry, "window", what, file);
  change.level = finite_number(entry, "level", what, file);
  if (change.window && !(*change.window > 0.0))
    throw input_error("{}: 'window' of {} is {}; accepted: a width above 0", place, what, *change.window);
  if (const toml::node* name = entry.get("transfer_function")) {
    const auto text = name->value<std::string>();
    if (!name->is_string() || text->empty())
      throw input_error("{}: 'transfer_function' of {} wants a preset or a file", place_of(*name, file),
                        what);
    change.transfer_function = transfer_function_from(folder, *text);
  }
  if (!change.transfer_function && !change.window && !change.level) {
    throw input_error("{}: an entry of {} changes nothing; accepted: transfer_function, window, level", place,
                      what);
  }
  return change;
}

std::optional<std::array<double, 2>> from_to(const toml::table& entry, const char* key,
                                             const std::string& file) {
  const toml::node* node = entry.get(key);
  if (node == nullptr) return std::nullopt;
  const toml::array* list = node->as_array();
  std::array<double, 2> values{};
  bool good = list != nullptr && list->size() == 2;
  for (std::size_t i = 0; good && i < 2; ++i) {
    const auto value = list->get(i)->value<double>();
    good = list->get(i)->is_number() && value && std::isfinite(*value);
    if (good) values[i] = *value;
  }
  if (!good)
    throw input_error("{}: 'scene.transfer_animation.{}' wants [from, to]", place_of(*node, file), key);
  return values;
}

TransferAnimation read_animation(const SessionTable& table) {
  const std::string file = table.file();
  const toml::table& entry = *table.node("scene.transfer_animation")->as_table();
  reject_unknown_keys(entry, file, "scene.transfer_animation", {"window", "level", "seconds"});
  TransferAnimation animation;
  animation.window = from_to(entry, "window", file);
  animation.level = from_to(entry, "level", file);
  animation.seconds = finite_number(entry, "seconds", "'scene.transfer_animation'", file).value_or(1.0);
  if (!animation.window && !animation.level)
    table.fail("scene.transfer_animation",
               "moves nothing; accepted: window = [from, to], level = [from, to]");
  if (animation.window && !((*animation.window)[0] > 0.0 && (*animation.window)[1] > 0.0))
    table.fail("scene.transfer_animation", "wants window widths above 0");
  if (!(animation.seconds >= 0.001 && animation.seconds <= 1e6))
    table.fail("scene.transfer_animation",
               fmt::format("has seconds = {}; accepted: 0.001 to 1e6", animation.seconds));
  return animation;
}

}  // namespace

std::string transfer_function_from(const std::filesystem::path& folder, const std::string& name) {
  return is_bare_name(name) ? name : absolute_from(folder, name).string();
}

void read_transfer_changes(const SessionTable& table, const std::filesystem::path& folder,
                           Session::Scene& scene) {
  if (const toml::node* changes = table.node("scene.transfer_change")) {
    for (const auto& entry : *changes->as_array()) {
      scene.transfer_changes.push_back(read_change(*entry.as_table(), folder, table.file()));
      const auto& all = scene.transfer_changes;
      if (all.size() > 1 && all.back().at_s <= all[all.size() - 2].at_s) {
        throw input_error("{}: entries of 'scene.transfer_change' are written in rising at_s",
                          place_of(entry, table.file()));
      }
    }
  }
  if (table.node("scene.transfer_animation") == nullptr) return;
  if (!scene.transfer_changes.empty()) {
    table.fail("scene.transfer_animation", "stands beside 'scene.transfer_change'; accepted: one of the two");
  }
  scene.transfer_animation = read_animation(table);
}

void write_absolute_transfer_changes(SessionTable& table, const Session::Scene& scene) {
  toml::array* changes = table.table().at_path("scene.transfer_change").as_array();
  for (std::size_t i = 0; i < scene.transfer_changes.size(); ++i) {
    if (const auto& name = scene.transfer_changes[i].transfer_function)
      changes->get(i)->as_table()->insert_or_assign("transfer_function", *name);
  }
}

}  // namespace brace
