#include "runtime/replay/stage_conflicts.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/replay/cast_integrator.hpp"
#include "runtime/replay/series_facts.hpp"
#include "runtime/replay/series_work.hpp"
#include "runtime/replay/single_pass.hpp"

namespace brace {

namespace {

/// Throws input_error where cells are to be shown one by one and cannot.
void require_swaps_of_cells(const Session& session, const PipelineStage& schedule) {
  if (schedule.value("swap") != 1.0) return;
  const auto refuse = [](const char* what, const char* accepted) {
    throw input_error(
        "schedule/chunked with swap = 'cell' does not work with {}; accepted: {}, or swap = 'frame'", what,
        accepted);
  };
  if (!cells_have_poses(schedule))
    refuse("poses = 'frame', which are one for all cells of a picture", "poses = 'cell'");
  if (schedule.value("cut") != 0.0)
    refuse("cut = 'cost', whose cells lie elsewhere in every frame", "cut = 'even'");
  if (session.clock.queue != "single")
    refuse("clock.queue other than 'single', where a warp overtakes the cell that is being cast",
           "clock.queue = 'single'");
}

}  // namespace

bool is_native(const Session& session, const char* family) {
  return session.pipeline.at(family).stage.native != nullptr;
}

void require_layers(const Session& session) {
  const std::string warp = session.pipeline.at("warp").stage.id();
  const auto refuse = [&](const std::string& what, const char* accepted) {
    throw input_error("{} does not work with {}; accepted: {}, or another warp", warp, what, accepted);
  };
  const StageInfo& cast = session.pipeline.at("cast").stage;
  const auto& outputs = cast.outputs;
  if (std::find(outputs.begin(), outputs.end(), "segments") == outputs.end())
    refuse(cast.id() + ", which does not give its segments", "cast/dvr and cast/native");
  const std::string rays = session.pipeline.at("rays").stage.id();
  if (rays != "rays/full_rate" && rays != "rays/mab")
    refuse(rays + ", which does not tell whose ray a pixel's is", "rays/full_rate and rays/mab");
  if (const std::string stereo = session.pipeline.at("stereo").stage.id(); stereo != "stereo/two_pass")
    refuse(stereo + ", whose second eye has no rays to make layers of", "stereo/two_pass");
}

void require_cells(const Session& session) {
  const auto refuse = [](const std::string& what, const char* accepted) {
    throw input_error("schedule/chunked does not work with {}; accepted: {}, or schedule/whole_frame", what,
                      accepted);
  };
  if (is_native(session, "rays"))
    refuse(session.pipeline.at("rays").stage.id(), "rays stages in GLSL, which open and close cells");
  const std::string stereo = session.pipeline.at("stereo").stage.id();
  if (is_single_pass(session)) {
    // The right eye is composed from the left one's cells: those come first.
    if (session.pipeline.at("schedule").value("order") != 0.0)
      throw input_error(
          "schedule/chunked with order = 'cost' or 'gaze' does not work with {}, whose right eye follows the "
          "left one's cells; accepted: order = 'rows', or stereo/two_pass",
          stereo);
  } else if (stereo != "stereo/two_pass") {
    refuse(stereo, "stereo/two_pass, stereo/layers and stereo/novel_view");
  }
  if (session.run.watchdog != WatchdogLevel::off)
    refuse(fmt::format("run.watchdog = '{}'", to_string(session.run.watchdog)), "'off'");
  if (session.clock.cost.rfind("recorded:", 0) == 0)
    refuse("clock.cost = 'recorded:…', which knows no cells", "other costs");
}

void require_cell_poses(const Session& session) {
  const PipelineStage& schedule = session.pipeline.at("schedule");
  require_swaps_of_cells(session, schedule);
  const bool own_poses = cells_have_poses(schedule);
  if (!own_poses && !session.clock.wall) return;
  const auto refuse = [&](const std::string& what, const char* accepted) {
    throw input_error("schedule/chunked with {} does not work with {}; accepted: {}, or {}",
                      own_poses ? "poses = 'cell'" : "clock.mode = 'wall'", what, accepted,
                      own_poses ? "poses = 'frame'" : "schedule/whole_frame");
  };
  const auto id = [&](const char* family) { return session.pipeline.at(family).stage.id(); };
  if (id("rays") != "rays/full_rate")
    refuse(id("rays") + ", whose pixels are not each of one cell", "rays/full_rate");
  if (id("stereo") != "stereo/two_pass")
    refuse(id("stereo") + ", whose eyes share their rays", "stereo/two_pass");
  if (id("skip") == "skip/occlusion")
    refuse("skip/occlusion, whose first hits are of whole eye frames", "another skip stage");
  const PipelineStage& warp = session.pipeline.at("warp");
  if (own_poses && (warp.stage.native != nullptr || takes_layers(warp)))
    refuse(warp.stage.id() + ", which takes an eye frame of one pose", "warp/none, warp/quad, warp/grid");
}

void require_levels(const Session& session) {
  if (const std::string stereo = session.pipeline.at("stereo").stage.id(); stereo != "stereo/two_pass") {
    throw input_error("{}: lod does not work with {}; accepted: stereo/two_pass, or lod = \"off\"",
                      session.pipeline.at("cast").stage.id(), stereo);
  }
}

void require_occlusion(const Session& session) {
  const auto refuse = [](const std::string& what, const char* accepted) {
    throw input_error("skip/occlusion does not work with {}; accepted: {}, or another skip stage", what,
                      accepted);
  };
  if (const std::string rays = session.pipeline.at("rays").stage.id(); rays != "rays/full_rate")
    refuse(rays + ", whose rays are not the pixels that first hits are known of", "rays/full_rate");
  if (is_native(session, "cast"))
    refuse(session.pipeline.at("cast").stage.id() + ", which is native", "cast/dvr");
  if (const std::string stereo = session.pipeline.at("stereo").stage.id(); stereo != "stereo/two_pass")
    refuse(stereo + ", whose second eye has no rays", "stereo/two_pass");
}

void require_agreement(const Session& session) {
  if (session.pipeline.at("schedule").stage.id() == "schedule/chunked") {
    require_cells(session);
    require_cell_poses(session);
  }
  if (session.pipeline.at("skip").stage.id() == "skip/occlusion") require_occlusion(session);
  if (wants_levels(session.pipeline.at("cast"))) require_levels(session);
  if (!needs_device(session)) return;
  if (is_single_pass(session)) require_single_pass(session);
  if (takes_layers(session.pipeline.at("warp"))) require_layers(session);
}

}  // namespace brace
