#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "hmd_sim/vsync.hpp"
#include "runtime/frame/transfer_schedule.hpp"
#include "runtime/session/session.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {

/// When a session's transfer function changes. Throws input_error for changes less than a nanosecond apart.
TransferSchedule transfer_schedule(const Session::Scene& scene, sim::Rate refresh);

/// The transfer functions of a run as tables, by version (TransferSchedule). Files are read once, here.
class TransferVersions {
 public:
  /// What tables are baked for.
  struct Target {
    ValueRange data_range;
    double voxel_length_m = 0.0;
    TableLayout layout;
  };

  TransferVersions() = default;
  /// Throws input_error for a transfer function that cannot be read.
  TransferVersions(const Session::Scene& scene, sim::Rate refresh, const std::filesystem::path& preset_folder,
                   const Target& target);

  TransferTable table(std::int64_t version) const;
  /// Version 0 as table() bakes it: in data units, per voxel length, the session's window in it.
  TransferFunction first_resolved() const;
  /// Puts such a function in the place of version 0; the session's window no longer counts there, and an
  /// animation ends.
  void replace_first(TransferFunction resolved);

  const TransferSchedule& schedule() const { return schedule_; }
  bool changes() const { return states_.size() > 1 || animation_; }

  /// The tables that structures should be good for: all those of a list; of an animation some from end to
  /// end.
  std::vector<TransferTable> typical_tables() const;

 private:
  struct State {
    TransferFunction function;
    std::optional<double> window, level;
  };
  TransferFunction resolve_state(const State& state) const;
  TransferTable bake_state(const State& state) const;
  State animated(double phase) const;  // 0: from, 1: to

  Target target_;
  std::vector<State> states_;  // by version, without an animation
  std::optional<Session::Scene::TransferAnimation> animation_;
  sim::VsyncClock vsyncs_{SimTime(), {90, 1}};
  TransferSchedule schedule_;
};

}  // namespace brace
