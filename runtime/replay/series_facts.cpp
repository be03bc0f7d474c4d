#include "runtime/replay/series_facts.hpp"

#include <algorithm>

namespace brace {

std::vector<StageChoice> stage_choices(const Session& session) {
  std::vector<StageChoice> choices;
  for (const std::string& family : stage_families()) {
    const auto found = session.pipeline.find(family);
    if (found != session.pipeline.end()) choices.push_back({family, found->second.stage.id()});
  }
  return choices;
}

std::vector<LeftOut> left_out(const Session& session, const Headset& headset) {
  std::vector<LeftOut> left;
  for (const auto& [family, chosen] : session.pipeline) {
    if (chosen.stage.name == "none") left.push_back({family, "the session names none"});
  }
  if (session.scene.shading == "none") left.push_back({"shading", "unlit: no gradient in the kernel"});
  if (lens_does_nothing(headset)) {
    if (!headset.distort_always) left.push_back({"distortion", "the lens polynomial is 1"});
  } else if (channels_equal(headset) && !headset.fetch_channels_always) {
    left.push_back({"chromatic channels", "the channels' polynomials are equal: one fetch instead of three"});
  }
  if (headset.profile.scan_out.direction == sim::ScanDirection::global) {
    left.push_back({"scan-out correction", "the panel is lit at once"});
  }
  return left;
}

bool warps_by_line(const PipelineStage& warp) {
  PipelineStage by_line = warp;
  return by_line.set_choice("scan_out", "lines") && by_line.values == warp.values;
}

bool cells_have_poses(const PipelineStage& schedule) {
  return schedule.stage.id() == "schedule/chunked" && schedule.value("poses") == 1.0;
}

WarpPose warp_pose_of(const PipelineStage& warp) {
  if (warp.stage.native != nullptr) return WarpPose::rotation_and_translation;
  const auto& inputs = warp.stage.inputs;
  const auto has = [&](const char* name) {
    return std::find(inputs.begin(), inputs.end(), name) != inputs.end();
  };
  if (has("translation")) return WarpPose::rotation_and_translation;
  return has("rotation") ? WarpPose::rotation : WarpPose::none;
}

}  // namespace brace
