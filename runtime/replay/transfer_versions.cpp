#include "runtime/replay/transfer_versions.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr int animation_samples = 9;  // of typical_tables

std::optional<double> between(const std::optional<std::array<double, 2>>& ends, double phase,
                              const std::optional<double>& otherwise) {
  if (!ends) return otherwise;
  return (*ends)[0] + ((*ends)[1] - (*ends)[0]) * phase;
}

}  // namespace

TransferSchedule transfer_schedule(const Session::Scene& scene, sim::Rate refresh) {
  if (scene.transfer_animation) return TransferSchedule::at_every_vsync(refresh);
  std::vector<SimTime> times;
  for (const auto& change : scene.transfer_changes) {
    const SimTime before = times.empty() ? SimTime() : times.back();
    times.push_back(SimTime(from_s(change.at_s)));
    if (times.back() <= before) {
      throw input_error("'scene.transfer_change': at_s = {} is not a nanosecond after what comes before it",
                        change.at_s);
    }
  }
  return TransferSchedule(std::move(times));
}

TransferVersions::TransferVersions(const Session::Scene& scene, sim::Rate refresh,
                                   const std::filesystem::path& preset_folder, const Target& target)
    : target_(target), animation_(scene.transfer_animation), vsyncs_(SimTime(), refresh) {
  const auto load = [&](const std::string& name) { return load_transfer_function(name, preset_folder); };
  states_.push_back({load(scene.transfer_function), scene.window, scene.level});
  for (const auto& change : scene.transfer_changes) {
    State state = states_.back();
    if (change.transfer_function) state.function = load(*change.transfer_function);
    if (change.window) state.window = change.window;
    if (change.level) state.level = change.level;
    states_.push_back(std::move(state));
  }
  schedule_ = transfer_schedule(scene, refresh);
}

TransferFunction TransferVersions::resolve_state(const State& state) const {
  TransferFunction function = state.function;
  if (state.window || state.level) {
    const ValueRange range = target_.data_range;
    function = with_window(function, {.level = state.level.value_or(0.5 * (range.min + range.max)),
                                      .width = state.window.value_or(range.max - range.min)});
  }
  return resolve(function, target_.data_range, target_.voxel_length_m);
}

TransferTable TransferVersions::bake_state(const State& state) const {
  return bake(resolve_state(state), target_.layout);
}

TransferFunction TransferVersions::first_resolved() const {
  return resolve_state(animation_ ? animated(0.0) : states_.front());
}

void TransferVersions::replace_first(TransferFunction resolved) {
  animation_.reset();
  states_.front() = {std::move(resolved), std::nullopt, std::nullopt};
}

TransferVersions::State TransferVersions::animated(double phase) const {
  State state = states_.front();
  state.window = between(animation_->window, phase, state.window);
  state.level = between(animation_->level, phase, state.level);
  return state;
}

TransferTable TransferVersions::table(std::int64_t version) const {
  if (!animation_) return bake_state(states_.at(static_cast<std::size_t>(version)));
  const double turns = to_s(vsyncs_.time_of(version) - SimTime()) / animation_->seconds;
  const double turn = turns - std::floor(turns);
  return bake_state(animated(1.0 - std::abs(1.0 - 2.0 * turn)));
}

std::vector<TransferTable> TransferVersions::typical_tables() const {
  std::vector<TransferTable> tables;
  if (animation_) {
    for (int i = 0; i < animation_samples; ++i)
      tables.push_back(bake_state(animated(static_cast<double>(i) / (animation_samples - 1))));
  } else {
    for (const State& state : states_)
      tables.push_back(bake_state(state));
  }
  return tables;
}

}  // namespace brace
