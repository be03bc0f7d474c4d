#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/frame_loop.hpp"
#include "runtime/gpu/device.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/ideal_cache.hpp"
#include "runtime/replay/replay.hpp"
#include "runtime/report/report_input.hpp"
#include "runtime/report/run_directory.hpp"

namespace brace {

/// What came of one session of a run; the report's series points into it.
struct Series {
  std::string label;
  RunRecords records;
  std::vector<JobRecord> jobs;  // by submission
  std::vector<EyePicture> pictures;
  std::vector<LeftOut> left_out;
  std::vector<StageChoice> pipeline;
  std::vector<Fact> facts, host_facts;  // host: measured here, not the same for equal runs
  bool deterministic = true;
  std::vector<WatchdogReport> faults;  // that the watchdog found
  std::string failure;                 // "" or what ended the run before its end
  FrameLoopResult loop;
  std::optional<double> stereo_layer_mib;  // memory of a single-pass stage's layers
};

/// Replays one session; pictures go into `run`, ideal pictures come from `ideals` and go there. `device` is
/// null when the session needs none. When a stage or the device fails after vsyncs have been shown, the
/// series ends there and says so in `failure`; before, that is thrown.
Series replay_series(const LabelledSession& labelled, const ReplayOptions& options, const Headset& headset,
                     const HeadTrace& head_trace, const gpu::Device* device, RunDirectory& run,
                     IdealCache& ideals);

}  // namespace brace
