// Eye frames whose cells are cast from poses of their own, and the warps that put them where they belong.
#include <gtest/gtest.h>

#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/panel_display.hpp"
#include "tests/unit/accelerations/eye_rig.hpp"

namespace brace {
namespace {

class CellPosesTest : public gpu::GpuTest {};

constexpr int kEdge = 4;

/// Cell by cell the head turns and moves on, in the order in which they are cast.
Pose head_of(int cell) {
  return moved_head(0.0004 * cell, 0.0002 * cell, 0.0, 0.006 * cell);
}

struct Shown {
  AccelerationsRig rig;
  PanelDisplay display;

  Shown(const gpu::Device& device, const std::string& warp, bool own_poses)
      : rig(device, accelerations_session("generator:nested_shells:32", upper_half(), "distance_map")),
        display(device, rig.headset, accelerations_stage("warp", warp), accelerations_stage("warp", "none"),
                scene_activation(device, rig.session, rig.headset, *rig.scene, rig.placement),
                accelerations_data, own_poses) {}

  CellPoses cast_cells(const std::array<CellCuts, 2>& cuts) {
    CellPoses poses{cuts, {}};
    for (int cell = 0; cell < 2 * kEdge * kEdge; ++cell) {
      rig.renderer.render_cell(head_of(cell), rig.eyes, cell, {kEdge, kEdge, cuts});
      poses.world_from_head[static_cast<std::size_t>(cell / (kEdge * kEdge))].push_back(head_of(cell));
    }
    return poses;
  }

  PanelPair at(const Pose& then, const Pose& now, const CellPoses* poses = nullptr) {
    display.show(
        {.eyes = rig.eyes, .render_world_from_head = then, .warp_world_from_head = now, .cell_poses = poses});
    return display.read();
  }

  double error(const PanelPair& panels, const PanelPair& ideal) const {
    double sum = 0.0;
    for (const sim::Eye eye : sim::all_eyes) {
      const auto i = static_cast<std::size_t>(eye);
      sum += dssim_from_ssim(ssim(panels[i], ideal[i], visible_pixels(rig.headset, eye))) / 2.0;
    }
    return sum;
  }
};

PanelPair ideal_at(const gpu::Device& device, const Pose& head) {
  Shown shown(device, "none", false);
  shown.rig.render(head);
  return shown.at(head, head);
}

std::array<CellCuts, 2> uneven_cuts() {
  CellCuts cuts(kEdge, kEdge);
  cuts.bands = {0.0, 0.3, 0.45, 0.5, 1.0};
  for (std::size_t band = 0; band < kEdge; ++band)
    cuts.columns_in_band[band * (kEdge + 1) + 2] += 0.05 * static_cast<double>(band);
  return {cuts, cuts};
}

TEST_F(CellPosesTest, WarpsPutEveryCellWhereItsPoseSays) {
  // The head that the display is told of has gone on beyond all that cells have seen.
  const Pose now = head_of(34), middle = head_of(16);
  const PanelPair ideal = ideal_at(device(), now);
  for (const auto& [warp, cuts] : {std::pair<std::string, std::array<CellCuts, 2>>{
                                       "quad", {CellCuts(kEdge, kEdge), CellCuts(kEdge, kEdge)}},
                                   {"grid", {CellCuts(kEdge, kEdge), CellCuts(kEdge, kEdge)}},
                                   {"grid", uneven_cuts()}}) {
    Shown cells(device(), warp, true), one(device(), warp, false);
    const CellPoses poses = cells.cast_cells(cuts);
    one.cast_cells(cuts);
    const double own = cells.error(cells.at(middle, now, &poses), ideal);
    const double as_one = one.error(one.at(middle, now), ideal);
    one.rig.render(middle);
    const double frame = one.error(one.at(middle, now), ideal);
    EXPECT_LT(own, 0.5 * as_one) << warp << ": it must read each cell's own pose";
    EXPECT_LT(own, 1.3 * frame) << warp << ": as good as an eye frame of one pose";
  }
}

TEST_F(CellPosesTest, WithoutMovementPicturesAreThoseOfOnePose) {
  const Pose head = head_of(7);
  for (const char* warp : {"none", "quad", "grid"}) {
    Shown cells(device(), warp, true), one(device(), warp, false);
    CellPoses poses{uneven_cuts(), {}};
    for (int cell = 0; cell < 2 * kEdge * kEdge; ++cell) {
      cells.rig.renderer.render_cell(head, cells.rig.eyes, cell, {kEdge, kEdge, poses.cuts});
      poses.world_from_head[static_cast<std::size_t>(cell / (kEdge * kEdge))].push_back(head);
    }
    one.rig.render(head);
    EXPECT_EQ(cells.rig.picture(), one.rig.picture()) << "the eye frame itself";
    const Pose now = head_of(9);
    EXPECT_EQ(cells.at(head, now, &poses)[0].pixels, one.at(head, now)[0].pixels) << warp;
  }
}

}  // namespace
}  // namespace brace
