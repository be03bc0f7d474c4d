#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/image.hpp"
#include "runtime/gpu/device.hpp"
#include "runtime/plan/scene_facts.hpp"
#include "runtime/replay/replay.hpp"

namespace brace {

/// What a short replay without pictures tells of a session.
struct PlanTrial {
  double frame_ms = 0.0;           // of the simulated GPU, per eye frame shown once (GpuTime)
  double angular_error_deg = 0.0;  // shown against true orientation, p95
  double position_error_mm = 0.0;  // shown against true position, p95
  bool deterministic = true;
};

/// Tries sessions out, on one device opened at the first trial.
class PlanTrials {
 public:
  static constexpr int probes = 6;             // eye frames rendered per trial
  static constexpr std::int64_t frames = 180;  // vsyncs replayed; fewer where the trace or the session ends
  static constexpr int pictures = 3;           // begin, middle and end of those vsyncs

  explicit PlanTrials(ReplayOptions options);
  ~PlanTrials();

  const std::filesystem::path& data_folder() const { return options_.data_folder; }

  /// Throws brace::Error as replay() does. A session is replayed once.
  PlanTrial replay_briefly(const Session& session);

  /// DSSIM between what the panels show of two sessions, the same head poses and no warp: the largest over
  /// `pictures` poses and both eyes. Empty where a session renders nothing.
  std::optional<double> picture_change(const Session& a, const Session& b);

  /// The same between a session and itself with converged steps. Empty also where cast/dvr does not cast.
  std::optional<double> picture_error(const Session& session);

  /// What the transfer function makes of the session's volume. Empty where a session renders nothing.
  std::optional<VolumeFacts> look_at_volume(const Session& session);

 private:
  struct Pictures;
  PlanTrial replay_now(const Session& session);
  const Pictures& pictures_of(const Session& session, bool converged = false);
  static double largest_dssim(const Pictures& a, const Pictures& b);
  const gpu::Device* device_for(const Session& session);

  ReplayOptions options_;
  std::optional<gpu::Device> device_;
  std::map<std::string, PlanTrial> replayed_;              // by resolved session
  std::map<std::string, std::unique_ptr<Pictures>> made_;  // by resolved session, converged or not
};

}  // namespace brace
