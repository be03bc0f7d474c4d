#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>

#include "runtime/frame/frame_work.hpp"
#include "runtime/mab/mab_braces.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/raycast/segment_replay.hpp"
#include "runtime/replay/headset.hpp"
#include "runtime/replay/scan_line_rays.hpp"
#include "runtime/replay/scene.hpp"
#include "runtime/replay/scene_activation.hpp"
#include "runtime/replay/single_pass.hpp"
#include "runtime/replay/stage_conflicts.hpp"
#include "runtime/skip/first_hit_maps.hpp"

namespace brace {

EyePair make_eye_pair(const gpu::Device& device, PictureSize size, RayLayers layers = {});

/// Those that the session's warp needs. Throws input_error for stages that cannot give layers to one that
/// takes them.
EyePair make_eye_pair(const gpu::Device& device, const Session& session, const Headset& headset);

/// Ray casts both eyes of a head pose. Everything given must outlive it.
class EyeRenderer {
 public:
  enum class Counting { off, on };
  /// Where the second eye's picture comes from: the session's stereo stage, or rays of its own whatever that
  /// says.
  enum class SecondEye { as_session, ray_cast };
  /// Whether layers are made for the session's warp, into targets that have them; only for warps that take
  /// some.
  enum class Layers { none, as_session };
  /// Whether skip/occlusion, if the session has it, learns from each frame for the next one: where they
  /// follow each other in time. Without it every ray begins at its entry.
  enum class History { none, as_session };

  /// What a ray's colour is instead of the volume's: grey by the count of its work, (1 + 254 h) / 255 with h
  /// = min(log2(1 + count) / 10, 1); a ray that misses the volume stays black. Of cast stages in GLSL alone.
  enum class RayHeat { none, samples, skip_steps };

  /// The session's stages for rays, cast, skip and stereo are taken from its pipeline; any may be native.
  /// Throws device_error when a stage cannot be activated. `watchdog` may be null; what it watches is checked
  /// after every eye.
  EyeRenderer(const gpu::Device& device, const Session& session, const Headset& headset,
              const SceneOnDevice& scene, const VolumePlacement& placement,
              const std::filesystem::path& data_folder, Counting counting, Watchdog* watchdog = nullptr,
              SecondEye second_eye = SecondEye::as_session, Layers layers = Layers::none,
              RayHeat heat = RayHeat::none, History history = History::none);

  /// `quality`: the share of the rays that load control asks for; only rays/mab can cast fewer.
  JobOutcome render(const Pose& world_from_head, const EyePair& into, double quality = 1.0);

  /// Device time of the last render(), both eyes. All of it is `cast` where its steps are not told apart:
  /// native stages, a watchdog, one pass for both eyes.
  struct StepTimes {
    SimDuration opening{0}, cast{0}, closing{0};
  };
  const StepTimes& step_times() const { return step_times_; }

  struct Cells {
    int columns = 0, rows = 0;         // of each eye
    std::span<const CellCuts> cuts{};  // of the left and the right eye; empty: even
  };
  /// The same in cells over each eye's rays, each cell on its own; valid until the next call. For what
  /// require_cells accepts.
  JobOutcome render_cells(const Pose& world_from_head, const EyePair& into, double quality,
                          const Cells& cells);

  /// One of those cells alone, from a pose of its own, into an eye frame whose other cells stay as they are.
  /// For what require_cell_poses accepts.
  CellOutcome render_cell(const Pose& world_from_head, const EyePair& into, int number, const Cells& cells);

  /// Full rate, each ray from where the eye is when the panel shows its pixel. The session's rays are those
  /// of ScanLineRays::opening.
  JobOutcome render_by_line(const ScanPoses& world_from_head, const EyePair& into);

  /// Where the eyes look from the next frame on, in the head frame: for rays/mab with a gaze that moves.
  void look_at(const glm::dvec3& gaze) {
    if (mab_) mab_->look_at(gaze);
    if (single_pass_) single_pass_->look_at(gaze);
  }

  /// Call after the scene's transfer function has changed: native stages, which have it from their
  /// activation, are activated anew.
  void transfer_changed();

  /// Call where the transfer function changed and kept its version: what the last frame has shown to be empty
  /// is no more.
  void forget_first_hits();

  /// What became of single-pass stereo so far, for the report; empty without it.
  std::string stereo_note() const { return single_pass_ ? single_pass_->note() : std::string(); }

 private:
  void activate_native_stages();
  EyeCast eye_cast(sim::Eye eye, const EyeView& view, const CastPipeline::Resources& resources);
  SegmentReplay* segments() { return makes_layers_ && native_cast_ ? &replay_ : nullptr; }
  void set_eye(sim::Eye eye, const EyeView& view, const EyeTarget& target);
  void keep_first_hits(gpu::CommandList& commands, sim::Eye eye, const EyeTarget& target);
  CastPipeline::Resources resources_of(sim::Eye eye, const EyeTarget& target, const RayBuffers& rays);
  /// The braces of rays that cast_on_host() casts, on the host where they may work there.
  SimDuration open(const EyeCast& eye, const CastArea& rays);
  SimDuration close(const EyeCast& eye, const CastArea& image);
  JobOutcome render_by_steps(const Pose& world_from_head, const EyePair& into);
  CellOutcome cast_cell(sim::Eye eye, const EyeView& view, const CastPipeline::Resources& resources,
                        const CastArea& area);
  template <class Record>
  SimDuration submit_step(const char* name, const Record& record);
  EyeCastOutcome cast_eye_by_steps(sim::Eye eye, const Pose& world_from_head, const EyeTarget& target);
  const RayBuffers& rays() const { return mab_ ? mab_->rays() : own_rays_; }
  std::int64_t compose_right_eye(const Pose& world_from_head, const EyePair& into);

  const gpu::Device& device_;
  const Session& session_;
  const Headset& headset_;
  const SceneOnDevice& scene_;
  VolumePlacement placement_;
  Counting counting_;
  bool makes_layers_;
  CastPipeline pipeline_;
  std::unique_ptr<MabBraces> mab_;  // null unless the session's rays are rays/mab's
  RayBuffers own_rays_;             // empty with mab_
  bool full_rate_ = false;          // rays/full_rate
  std::vector<gpu::Binding> bindings_;
  std::vector<CellOutcome> cells_;  // of the last render_cells
  StepTimes step_times_;
  gpu::CommandList commands_;

  // Empty where the pipeline's kernels do the work.
  std::optional<ActiveStage> native_rays_, native_cast_, native_stereo_;
  HostRays host_rays_;
  SegmentReplay replay_;  // where the session's warp wants layers of a native cast
  Watchdog* watchdog_ = nullptr;
  std::uint64_t frame_ = 0;
  std::unique_ptr<SinglePass> single_pass_;     // null where each eye is ray cast
  std::optional<ScanLineRays> scan_line_rays_;  // from the first render_by_line on
  std::unique_ptr<FirstHitMaps> first_hits_;    // null without skip/occlusion
  bool keeps_first_hits_ = false;
};

template <class Record>
SimDuration EyeRenderer::submit_step(const char* name, const Record& record) {
  commands_.reset();
  commands_.barrier();
  commands_.begin_timing(name);
  record();
  commands_.barrier();
  commands_.end_timing();
  return SimDuration(gpu::total_ns(gpu::submit_and_wait(commands_)));
}

}  // namespace brace
