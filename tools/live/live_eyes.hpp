#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/replay.hpp"
#include "runtime/replay/stage_instance.hpp"
#include "tools/live/live_view.hpp"

namespace brace {

/// A session's eyes, rendered for whatever pose the head has; and anew when its stages' files change. The
/// device and what the options name must outlive it.
class LiveEyes {
 public:
  /// A session, and every stage that it could name.
  struct Read {
    Session session;
    std::vector<StageInfo> stages{};
  };
  using ReadSession = std::function<Read()>;  // with the stages as they are on disk now

  LiveEyes(const gpu::Device& device, const ReplayOptions& options, ReadSession read, const Pose& first_pose);

  const Session& session() const { return now_->session; }
  const Headset& headset() const { return now_->headset; }
  const SceneOnDevice& scene() const { return *now_->scene; }
  const std::vector<StageInfo>& stages() const { return now_->stages; }

  /// Where the session's predict stage expects the head at `target`. Throws device_error when it fails.
  Pose predicted(std::span<const brace_tracker_sample> readings, SimTime target) const;
  /// Asks the session's control stage how many of the rays the next show() casts. `budget`: what a picture
  /// may take of the device. Throws device_error when it fails.
  void control(SimDuration cast, SimDuration budget, std::int64_t missed);
  double quality() const { return now_->quality; }  // the share of the rays that is cast

  struct Times {
    double opening_ms = 0.0, cast_ms = 0.0, closing_ms = 0.0, warp_ms = 0.0;  // device time
    WorkCounts work;
  };
  /// Ray casts from one pose and shows the panels as seen from another, which is asked for in between.
  Times show(const Pose& render_pose, const std::function<Pose()>& warp_pose);
  /// What the panels show of the last show().
  PanelPair read() const { return now_->display.read(); }
  /// Those panels as the view in force shows them.
  PanelPair viewed(PanelPair shown);

  /// Another transfer function, in data units and per voxel length, in the session's place: for the tables,
  /// the skip structure and native stages, without a new kernel. It stays until the session's own is saved
  /// anew.
  void set_transfer(const TransferFunction& resolved);
  TransferFunction transfer() const { return now_->scene->versions.first_resolved(); }

  /// Another view from the next show() on; why not, in words, where the session has nothing of the kind: the
  /// one before goes on then. Empty: it does.
  std::string set_view(ViewKind kind);
  ViewKind view() const { return now_->view ? now_->view->kind() : ViewKind::picture; }
  ViewLegend legend() const { return now_->view ? now_->view->legend() : ViewLegend(); }

  /// Looks at the files of stages and transfer function and makes anew what has been saved: kernels alone,
  /// or the scene as well. What went wrong, in the words of the compiler or reader; the old ones go on then.
  /// A view that the session no longer has ends. Empty: nothing did.
  std::optional<std::string> reload_if_saved();
  /// Makes everything anew that depends on what the session reads as now; the volume stays where it is the
  /// same. The same words.
  std::string remake();

 private:
  struct State {
    /// `before`: null, or what may give its scene, or its volume alone.
    enum class Keep { nothing, volume, scene };
    State(const gpu::Device& device, const ReplayOptions& options, Read read, const Pose& first_pose,
          const State* before, Keep keep);
    Session session;
    std::vector<StageInfo> stages;
    Headset headset;
    VolumePlacement placement;
    std::shared_ptr<SceneOnDevice> scene;
    EyeRenderer renderer;
    PanelDisplay display;
    EyePair eyes;
    NativeStage predict, control;
    double quality = 1.0;
    std::uint64_t frame = 0;
    std::unique_ptr<LiveView> view;  // null: the picture
  };
  std::unique_ptr<LiveView> make_view(State& state, ViewKind kind) const;
  using Stamp = std::pair<std::filesystem::path, std::filesystem::file_time_type>;
  using Stamps = std::vector<Stamp>;
  std::string make(State::Keep keep);
  void show_edited();
  Stamps volume_stamps() const;
  Stamps scene_stamps() const;  // session, transfer function, manifests, the skip stage
  Stamps kernel_stamps() const;

  const gpu::Device& device_;
  const ReplayOptions& options_;
  ReadSession read_;
  Pose first_pose_;
  std::unique_ptr<State> now_;
  Pose render_pose_, warp_pose_;  // of the last show()
  std::optional<TransferFunction> edited_;
  Stamps volume_stamps_, scene_stamps_, kernel_stamps_;
};

}  // namespace brace
