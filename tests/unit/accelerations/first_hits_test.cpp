// skip/occlusion: rays begin behind what the last frame has shown to be empty, and the picture stays the
// same.
#include <numbers>

#include "runtime/skip/first_hit_maps.hpp"
#include "tests/unit/accelerations/eye_rig.hpp"

namespace brace {
namespace {

constexpr const char* shells = "generator:nested_shells:40";

class FirstHits : public gpu::GpuTest {
 protected:
  static Session with_occlusion(const std::string& transfer = upper_half(), const char* behind = "none") {
    Session session = accelerations_session(shells, transfer, "occlusion");
    EXPECT_TRUE(session.pipeline.at("skip").set_choice("behind", behind));
    return session;
  }

  /// Renders the heads one after the other with and without the stage; every picture must be the same.
  static void expect_same_pictures(Session session, std::span<const Pose> heads) {
    AccelerationsRig leaping(device(), session);
    session.pipeline.at("skip") = accelerations_stage("skip", "none");
    AccelerationsRig plain(device(), session);
    for (std::size_t i = 0; i < heads.size(); ++i) {
      leaping.render(heads[i]);
      plain.render(heads[i]);
      EXPECT_EQ(leaping.picture(), plain.picture()) << "frame " << i;
    }
  }
};

/// Samples of a frame with the stage over those without it, at the second of two heads.
double share_of_samples(const gpu::Device& device, Session session, const Pose& first, const Pose& second) {
  AccelerationsRig leaping(device, session);
  leaping.render(first);
  const double samples = static_cast<double>(leaping.render(second).samples);
  session.pipeline.at("skip") = accelerations_stage("skip", "none");
  AccelerationsRig plain(device, session);
  return samples / static_cast<double>(plain.render(second).samples);
}

TEST_F(FirstHits, ParametersFindThePixelOfAPointInTheOldView) {
  VolumeInfo info;
  info.dims = {20, 30, 40};
  info.spacing = {1.0, 1.5, 2.0};
  const VolumePlacement placement{moved_head(0.1, 0.2, -0.9, 0.3), 0.5};
  EyeView view{.world_from_eye = moved_head(0.03, -0.01, 0.02, -0.2),
               .tan_left = -0.9,
               .tan_right = 0.7,
               .tan_bottom = -0.8,
               .tan_top = 0.6,
               .width_px = 50,
               .height_px = 40};
  const OcclusionSettings settings{.tile_px = 5};
  const BraceOcclusionParams params = occlusion_params(view, view, info, placement, settings, 3);
  EXPECT_EQ(params.tiles[0], 10u);
  EXPECT_EQ(params.tiles[1], 8u);
  EXPECT_EQ(params.tiles[2], 3u);
  for (const auto& [u, v, ahead_m] : {std::array{3.0, 7.0, 0.4}, {25.0, 20.0, 1.0}, {49.5, 0.5, 2.0}}) {
    const glm::dvec3 in_eye(ahead_m * (view.tan_left + u / 50.0 * 1.6), ahead_m * (0.6 - v / 40.0 * 1.4),
                            -ahead_m);
    const glm::dvec3 voxel = voxel_from_world(info, placement, transform_point(view.world_from_eye, in_eye));
    const glm::dvec3 from_eye = voxel - glm::dvec3(params.eye[0], params.eye[1], params.eye[2]);
    const auto times = [&](const float(&row)[4]) {
      return glm::dot(glm::dvec3(row[0], row[1], row[2]), from_eye);
    };
    EXPECT_NEAR(times(params.ahead), ahead_m / metres_per_unit(info, placement), 1e-3);
    EXPECT_NEAR(times(params.column) / times(params.ahead), u / 5.0, 1e-4);
    EXPECT_NEAR(times(params.row) / times(params.ahead), v / 5.0, 1e-4);
  }
}

TEST_F(FirstHits, AJumpRemembersNothing) {
  VolumeInfo info;
  info.dims = {20, 20, 20};
  const VolumePlacement placement{moved_head(0, 0, -1), 0.5};
  EyeView seen;
  seen.width_px = seen.height_px = 8;
  EyeView next = seen;
  const OcclusionSettings settings{.move_m_max = 0.1, .turn_rad_max = 0.5};
  const auto tiles = [&] { return occlusion_params(seen, next, info, placement, settings, 0).tiles[0]; };
  EXPECT_GT(tiles(), 0u);
  next.world_from_eye.position.x = 0.0999;
  EXPECT_GT(tiles(), 0u);
  next.world_from_eye.position.x = 0.1001;
  EXPECT_EQ(tiles(), 0u);
  next.world_from_eye = moved_head(0, 0, 0, 0.499);
  EXPECT_GT(tiles(), 0u);
  next.world_from_eye = moved_head(0, 0, 0, std::numbers::pi);
  EXPECT_EQ(tiles(), 0u);
}

TEST_F(FirstHits, AStillEyeSeesTheSameWithFewerSamplesUnderEveryIntegrator) {
  struct Case {
    const char* integrator;
    double tolerance;
    const char* behind;
  };
  for (const Case& one : {Case{"midpoint-exponential", 0.0, "none"},
                          {"midpoint-exponential", 0.0, "distance_map"},
                          {"left", 0.0, "none"},
                          {"linear-source", 0.0, "none"},
                          {"pre-integrated", 0.0, "distance_map"},
                          {"linear-source", 0.01, "none"}}) {
    SCOPED_TRACE(std::string(one.integrator) + ", " + one.behind);
    Session session = with_occlusion(upper_half(), one.behind);
    EXPECT_TRUE(session.pipeline.at("cast").set_choice("integrator", one.integrator) &&
                session.pipeline.at("cast").set("tolerance", one.tolerance));
    AccelerationsRig rig(device(), session);
    const WorkCounts first = rig.render(Pose{});
    const std::vector<std::uint32_t> picture = rig.picture();
    for (int frame = 1; frame < 3; ++frame) {
      const WorkCounts next = rig.render(Pose{});
      EXPECT_EQ(rig.picture(), picture);
      EXPECT_LT(next.samples, first.samples);
      EXPECT_GT(next.skip_steps, 0u);
    }
  }
}

TEST_F(FirstHits, TheFirstFrameKnowsNothing) {
  AccelerationsRig leaping(device(), with_occlusion());
  AccelerationsRig plain(device(), accelerations_session(shells, upper_half()));
  const WorkCounts with = leaping.render(Pose{});
  EXPECT_EQ(with.samples, plain.render(Pose{}).samples);
  EXPECT_EQ(with.skip_steps, 0u);
  EXPECT_EQ(leaping.picture(), plain.picture());
}

TEST_F(FirstHits, SmoothMotionKeepsThePictureBitForBit) {
  std::vector<Pose> heads;
  for (int i = 0; i < 10; ++i)
    heads.push_back(moved_head(0.004 * i, 0.002 * i, -0.003 * i, 0.015 * i));
  expect_same_pictures(with_occlusion(), heads);
  EXPECT_LT(share_of_samples(device(), with_occlusion(), heads[4], heads[5]), 0.9);
}

TEST_F(FirstHits, ATurnOfHalfACircleAndBackIsSurvived) {
  const double half = std::numbers::pi;
  const Pose heads[] = {Pose{}, moved_head(0, 0, 0, half), Pose{}, moved_head(0, 0, 0, half), Pose{}};
  expect_same_pictures(with_occlusion(), heads);
  Session far = with_occlusion();  // where every view is remembered, however far
  EXPECT_TRUE(far.pipeline.at("skip").set("turn_deg_max", 180.0));
  EXPECT_TRUE(far.pipeline.at("skip").set("move_m_max", 10.0));
  expect_same_pictures(far, heads);
}

TEST_F(FirstHits, AnEyeInsideTheVolumeSeesTheSame) {
  const Pose heads[] = {moved_head(0, 0, -0.8),         moved_head(0, 0, -0.8),
                        moved_head(0.01, 0, -0.81),     moved_head(0.01, 0, -0.81, 0.1),
                        moved_head(-0.02, 0.01, -0.79), moved_head(-0.02, 0.01, -0.7),
                        moved_head(-0.02, 0.01, -0.56)};
  expect_same_pictures(with_occlusion(), heads);
  expect_same_pictures(with_occlusion(upper_half(), "distance_map"), heads);
}

TEST_F(FirstHits, AnEmptyVolumeCostsEachRayOnceInRefreshFrames) {
  Session session = with_occlusion(written_transfer("nothing", 0.0));
  AccelerationsRig rig(device(), session);
  const WorkCounts all = rig.render(Pose{});
  EXPECT_GT(all.samples, 0u);
  std::uint64_t samples = 0;
  for (int frame = 0; frame < 8; ++frame)
    samples += rig.render(Pose{}).samples;
  EXPECT_EQ(samples, all.samples);
  EXPECT_TRUE(session.pipeline.at("skip").set("refresh_frames", 0));
  AccelerationsRig never(device(), session);
  never.render(Pose{});
  EXPECT_EQ(never.render(Pose{}).samples, 0u);
}

TEST_F(FirstHits, AnOpaqueFirstSampleIsStillSeen) {
  Session session = accelerations_session("generator:slab:24", written_transfer("wall", 1.0), "occlusion");
  std::vector<Pose> heads = {Pose{}, Pose{}, moved_head(0.01, 0, -0.05), moved_head(0.01, 0, -0.02, 0.05)};
  expect_same_pictures(session, heads);
}

TEST_F(FirstHits, ANewTransferFunctionIsSeenAtOnce) {
  Session session = with_occlusion(written_transfer("nothing", 0.0));
  session.scene.transfer_changes.push_back(
      {.at_s = 1.0, .transfer_function = written_transfer("wall", 1.0), .window = {}, .level = {}});
  AccelerationsRig rig(device(), session);
  AccelerationsRig plain(device(), accelerations_session(shells, written_transfer("wall", 1.0)));
  rig.scene->show_transfer(device(), 0);
  rig.render(Pose{});
  rig.render(Pose{});
  rig.scene->show_transfer(device(), 1);
  const WorkCounts changed = rig.render(Pose{});
  EXPECT_EQ(changed.samples, plain.render(Pose{}).samples);
  EXPECT_EQ(rig.picture(), plain.picture());
}

TEST_F(FirstHits, CellsSeeTheSame) {
  AccelerationsRig whole(device(), with_occlusion()), cells(device(), with_occlusion());
  for (int frame = 0; frame < 3; ++frame) {
    const Pose head = moved_head(0.004 * frame, 0, 0, 0.01 * frame);
    const WorkCounts expected = whole.render(head);
    const WorkCounts got = cells.renderer.render_cells(head, cells.eyes, 1.0, {.columns = 3, .rows = 2}).work;
    EXPECT_EQ(cells.picture(), whole.picture());
    EXPECT_EQ(got.samples, expected.samples);
    EXPECT_EQ(got.skip_steps, expected.skip_steps);
    EXPECT_EQ(got.skip_steps > 0, frame > 0);
  }
}

TEST_F(FirstHits, StagesWhoseRaysBeginElsewhereAreRefusedByName) {
  const auto message = [](const char* family, const char* name) -> std::string {
    Session session = with_occlusion();
    session.pipeline.at(family) = accelerations_stage(family, name);
    try {
      require_occlusion(session);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("rays", "mab").find("rays/mab"), std::string::npos);
  EXPECT_NE(message("stereo", "novel_view").find("stereo/novel_view"), std::string::npos);
  EXPECT_EQ(message("rays", "full_rate"), "");
}

}  // namespace
}  // namespace brace
