#include "runtime/session/mab_level_items.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr int levels_max = 8;  // scale_0 … scale_7

/// What rays/mab's parameters say of its levels.
struct Levels {
  std::vector<double> scale, begin;  // begin[0] is 0
};

Levels levels_of(const PipelineStage& rays) {
  Levels levels;
  if (rays.stage.id() != "rays/mab") return levels;
  for (int i = 0; i < static_cast<int>(rays.value("levels")); ++i) {
    levels.scale.push_back(rays.value(fmt::format("scale_{}", i)));
    levels.begin.push_back(i == 0 ? 0.0 : rays.value(fmt::format("anchor_{}", i)));
  }
  return levels;
}

void take_out(Levels& levels, std::size_t level) {
  const bool coarsest = level + 1 == levels.scale.size();
  levels.scale.erase(levels.scale.begin() + static_cast<std::ptrdiff_t>(level));
  levels.begin.erase(levels.begin.begin() + static_cast<std::ptrdiff_t>(coarsest ? level : level + 1));
}

}  // namespace

const std::vector<std::string>& mab_level_items() {
  static const std::vector<std::string> items = [] {
    std::vector<std::string> names;
    for (int i = 0; i < levels_max; ++i)
      names.push_back(fmt::format("mab_level_{}", i));
    return names;
  }();
  return items;
}

std::optional<int> mab_level_of(const std::string& item) {
  const auto& items = mab_level_items();
  const auto found = std::find(items.begin(), items.end(), item);
  if (found == items.end()) return std::nullopt;
  return static_cast<int>(found - items.begin());
}

std::vector<double> mab_scales(const PipelineStage& rays) {
  return levels_of(rays).scale;
}

void take_out_mab_levels(PipelineStage& rays, const std::vector<std::string>& items) {
  Levels levels = levels_of(rays);
  const std::size_t asked_for = levels.scale.size();
  for (std::size_t level = asked_for; level-- > 0;)
    if (std::find(items.begin(), items.end(), mab_level_items()[level]) != items.end())
      take_out(levels, level);
  if (levels.scale.size() == asked_for) return;
  if (levels.scale.empty()) {
    throw input_error(
        "'plan.leave_out' names every level of rays/mab; accepted: all but one, or 'rays' to do without it");
  }
  rays.set("levels", static_cast<double>(levels.scale.size()));
  for (std::size_t i = 0; i < levels.scale.size(); ++i) {
    rays.set(fmt::format("scale_{}", i), levels.scale[i]);
    if (i > 0) rays.set(fmt::format("anchor_{}", i), levels.begin[i]);
  }
}

}  // namespace brace
