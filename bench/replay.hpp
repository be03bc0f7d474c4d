#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/timeline/cost_model.hpp"

namespace brace {

/// Pacing-only replay on one core: HTC Vive timing (90 Hz), a looping minute of natural head motion, constant
/// counted work priced by a model, constant-rate prediction, late-latched warps.
struct ReplayBenchOptions {
  double simulated_hours = 24;
  CostModel model;
};

struct ReplayBenchCase {
  std::string name;  // "single", "priority", "dual"
  std::int64_t vsyncs = 0;
  double wall_s = 0;
  double cpu_s = 0;         // of the thread that replays: what other programs leave it does not count
  double vsyncs_per_s = 0;  // of CPU time
  std::vector<double> ns_per_vsync_by_hour;  // CPU time by simulated hour (the last may be short)
  double events_per_vsync = 0;
  std::int64_t duplicate_predictions = 0;
  std::int64_t missed_vsyncs = 0;
  std::int64_t eye_frames = 0;
};

struct ReplayBenchResult {
  std::string model;
  double simulated_hours = 0;
  std::vector<ReplayBenchCase> cases;  // the first over the whole time, the others over an hour
};

ReplayBenchResult bench_replay(const ReplayBenchOptions& options);

/// Both name the rival's published figures beside ours, as published.
std::string to_text(const ReplayBenchResult& result);
std::string to_json(const ReplayBenchResult& result);

}  // namespace brace
