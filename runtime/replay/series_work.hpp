#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/frame/frame_work.hpp"
#include "runtime/frame/head_motion.hpp"
#include "runtime/replay/pixel_work.hpp"

namespace brace {

/// What a session's work is made from. Everything must outlive it.
struct SeriesWorkInputs {
  const Session& session;
  const ReplayOptions& options;
  const Headset& headset;
  const HeadMotion& head;
  const VolumePlacement& placement;
  const gpu::Device* device;  // null when the session needs none
  std::int64_t vsyncs;        // of the whole run
  RunDirectory& run;
  const std::string& label;
  IdealCache& ideals;          // of the replay
  GazeMotion* gaze = nullptr;  // none: straight ahead
};

/// The work behind the frame loop of one session.
struct SeriesWork {
  std::unique_ptr<SceneOnDevice> scene;   // null where nothing is rendered
  std::unique_ptr<Watchdog> watchdog;     // null where the session wants none, or nothing is rendered
  std::unique_ptr<FrameWork> frame_work;  // uses the scene and the watchdog
  PixelWork* pixels = nullptr;            // the same, where it makes pictures
  std::vector<Fact> facts;                // for the report
  std::vector<Fact> host_facts;           // measured here: not the same for equal runs
  std::vector<LeftOut> left_out;
  std::optional<double> stereo_layer_mib;  // memory of a single-pass stage's layers
};

/// Pictures where the session wants some, or measures its costs; else counts from probes, or those of a
/// recording.
SeriesWork make_work(const SeriesWorkInputs& in);

/// Whether a session renders anything, if only to count work.
bool needs_device(const Session& session);

}  // namespace brace
