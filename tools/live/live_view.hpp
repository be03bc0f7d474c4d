#pragma once

#include <array>
#include <memory>
#include <optional>

#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/ideal_picture.hpp"
#include "tools/live/view_colours.hpp"

namespace brace {

/// A view other than the picture: what the eyes are rendered with, and what the panels then show. All but
/// differences and levels show the eye frame itself, through the lens without a warp.
class LiveView {
 public:
  /// Everything must outlive it.
  struct Inputs {
    const gpu::Device& device;
    const ReplayOptions& options;
    const Session& session;
    const Headset& headset;
    SceneOnDevice& scene;
    const VolumePlacement& placement;
  };
  /// Throws input_error where the session has nothing of the kind to show.
  LiveView(const Inputs& inputs, ViewKind kind);

  ViewKind kind() const { return kind_; }
  /// What the eyes are rendered with; null: the session's own renderer.
  EyeRenderer* renderer() { return heat_ ? &*heat_ : nullptr; }
  IdealPicture* ideal() { return ideal_ ? &*ideal_ : nullptr; }

  /// The view, from the eyes of a frame and what the panels show of them.
  PanelPair make(const PanelPair& shown, const EyePair& eyes, const Pose& render_world_from_head,
                 const Pose& warp_world_from_head);
  /// Of the last one made.
  const ViewLegend& legend() const { return legend_; }

 private:
  PanelPair compare(const PanelPair& shown, const Pose& warp_world_from_head);
  PanelPair scalar(const EyePair& eyes, const Pose& world_from_head);
  void make_levels();
  void put_depths(const EyePair& eyes, const Pose& world_from_head);

  Inputs in_;
  ViewKind kind_;
  PanelDisplay plain_;
  std::optional<EyeRenderer> heat_;
  std::optional<IdealPicture> ideal_;
  std::array<std::vector<std::uint8_t>, 2> visible_;  // of differences
  std::optional<EyePair> own_eyes_;                   // of depths and levels
  PanelPair levels_;                                  // as grey
  ViewLegend legend_;
};

}  // namespace brace
