#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/replay.hpp"

namespace brace {

/// A session's eyes, rendered for whatever pose the head has; and anew when its stages' files change. The
/// device and what the options name must outlive it.
class LiveEyes {
 public:
  using ReadSession = std::function<Session()>;  // with the stages as they are on disk now

  LiveEyes(const gpu::Device& device, const ReplayOptions& options, ReadSession read, const Pose& first_pose);

  const Session& session() const { return now_->session; }
  const Headset& headset() const { return now_->headset; }

  struct Times {
    double opening_ms = 0.0, cast_ms = 0.0, closing_ms = 0.0, warp_ms = 0.0;  // device time
    WorkCounts work;
  };
  /// Ray casts from one pose and shows the panels as seen from another, which is asked for in between.
  Times show(const Pose& render_pose, const std::function<Pose()>& warp_pose);
  PanelPair read() const { return now_->display.read(); }

  /// Looks at the files of stages and transfer function and makes anew what has been saved: kernels alone,
  /// or the scene as well. What went wrong, in the words of the compiler or reader; the old ones go on then.
  /// Empty: nothing did.
  std::optional<std::string> reload_if_saved();

 private:
  struct State {
    /// `scene`: one to go on with, or null to load it.
    State(const gpu::Device& device, const ReplayOptions& options, Session session, const Pose& first_pose,
          std::shared_ptr<SceneOnDevice> scene);
    Session session;
    Headset headset;
    VolumePlacement placement;
    std::shared_ptr<SceneOnDevice> scene;
    EyeRenderer renderer;
    PanelDisplay display;
    EyePair eyes;
  };
  using Stamp = std::pair<std::filesystem::path, std::filesystem::file_time_type>;
  using Stamps = std::vector<Stamp>;
  Stamps scene_stamps() const;  // session, transfer function, manifests, the skip stage
  Stamps kernel_stamps() const;

  const gpu::Device& device_;
  const ReplayOptions& options_;
  ReadSession read_;
  Pose first_pose_;
  std::unique_ptr<State> now_;
  Stamps scene_stamps_, kernel_stamps_;
};

}  // namespace brace
