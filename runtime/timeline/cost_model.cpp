#include "runtime/timeline/cost_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "base/toml_file.hpp"

namespace brace {

namespace {

struct BaseKey {
  const char* name;
  double CostModel::Base::*value;
};
struct ItemKey {
  const char* name;
  double CostModel::Item::*value;
};

constexpr std::array<BaseKey, 3> base_keys{{{"cast", &CostModel::Base::cast},
                                            {"warp", &CostModel::Base::warp},
                                            {"update", &CostModel::Base::update}}};
constexpr std::array<ItemKey, 6> item_keys{{{"ray", &CostModel::Item::ray},
                                            {"sample", &CostModel::Item::sample},
                                            {"skip_step", &CostModel::Item::skip_step},
                                            {"shading_fetch", &CostModel::Item::shading_fetch},
                                            {"texel", &CostModel::Item::texel},
                                            {"byte", &CostModel::Item::byte}}};

template <typename Keys>
std::vector<std::string> names_of(const Keys& keys) {
  std::vector<std::string> names;
  for (const auto& key : keys)
    names.emplace_back(key.name);
  return names;
}

/// A table of non-negative coefficients, all of which must be there.
template <typename Values, typename Keys>
void read_coefficients(const toml::table& root, const std::string& file, const char* table_name,
                       const Keys& keys, Values& values) {
  const toml::table* table = root[table_name].as_table();
  if (table == nullptr) throw input_error("{}: the table [{}] is missing", file, table_name);
  reject_unknown_keys(*table, file, table_name, names_of(keys));
  for (const auto& key : keys) {
    const toml::node* node = table->get(key.name);
    if (node == nullptr) {
      throw input_error("{}: {}.{} is missing; every coefficient must be there, 0 if free", file, table_name,
                        key.name);
    }
    const std::optional<double> value = node->value<double>();
    if (!value || !std::isfinite(*value) || *value < 0) {
      throw input_error("{}: {}.{} must be a number of nanoseconds >= 0", place_of(*node, file), table_name,
                        key.name);
    }
    values.*(key.value) = *value;
  }
}

}  // namespace

SimDuration evaluate(const CostModel& model, JobKind kind, const WorkCounts& work, double share) {
  const double base_ns = kind == JobKind::cast   ? model.base_ns.cast
                         : kind == JobKind::warp ? model.base_ns.warp
                                                 : model.base_ns.update;
  const auto part_ns = [](double price_ns, std::uint64_t count) {
    return price_ns * static_cast<double>(count);
  };
  const CostModel::Item& item = model.item_ns;
  const double ns = base_ns * share + part_ns(item.ray, work.rays) + part_ns(item.sample, work.samples) +
                    part_ns(item.skip_step, work.skip_steps) +
                    part_ns(item.shading_fetch, work.shading_fetches) + part_ns(item.texel, work.texels) +
                    part_ns(item.byte, work.bytes);
  if (!(ns < 9e18)) throw input_error("cost model '{}': a job's cost is beyond 2^63 ns", model.name);
  return SimDuration(std::llround(ns));
}

CostModel read_cost_model(const std::filesystem::path& file) {
  const toml::table root = read_toml_file(file);
  const std::string name = file.string();
  reject_unknown_keys(root, name, "", {"name", "summary", "base_ns", "item_ns"});
  CostModel model;
  model.name = root["name"].value_or(std::string());
  model.summary = root["summary"].value_or(std::string());
  if (model.name != file.stem().string()) {
    throw input_error("{}: name = '{}' must equal the file's name", name, model.name);
  }
  read_coefficients(root, name, "base_ns", base_keys, model.base_ns);
  read_coefficients(root, name, "item_ns", item_keys, model.item_ns);
  return model;
}

std::vector<std::string> cost_model_names(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::directory_iterator files(folder, error);
  if (error) throw input_error("{}: cannot list cost models: {}", folder.string(), error.message());
  std::vector<std::string> names;
  for (const std::filesystem::directory_entry& entry : files) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

CostModel find_cost_model(const std::filesystem::path& folder, const std::string& name) {
  const std::vector<std::string> names = cost_model_names(folder);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw input_error("cost model '{}' does not exist{}; there are: {}", name, did_you_mean(name, names),
                      join(names));
  }
  return read_cost_model(folder / (name + ".toml"));
}

std::string to_toml(const CostModel& model) {
  std::string text = fmt::format("name = \"{}\"\nsummary = \"{}\"\n\n[base_ns]\n", model.name, model.summary);
  for (const BaseKey& key : base_keys)
    text += fmt::format("{} = {}\n", key.name, model.base_ns.*(key.value));
  text += "\n[item_ns]\n";
  for (const ItemKey& key : item_keys)
    text += fmt::format("{} = {}\n", key.name, model.item_ns.*(key.value));
  return text;
}

}  // namespace brace
