#include "runtime/frame/gaze_motion.hpp"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/unit/frame/rig.hpp"

namespace brace {
namespace {

SimTime at(double milliseconds) {
  return SimTime(ms(milliseconds));
}

glm::dvec2 tan_of(const glm::dvec3& gaze) {
  return sim::gaze_tangents(gaze);
}

TEST(GazeMotion, AScriptGoesStraightFromPlaceToPlaceAndJumpsWhereTimesAreEqual) {
  GazeMotion gaze(
      {{at(100), {0.0, 0.0}}, {at(200), {0.4, 0.2}}, {at(200), {-1.0, 0.0}}, {at(300), {-1.0, 1.0}}}, ms(50));
  const auto expect = [&](double at_ms, glm::dvec2 tan) {
    EXPECT_NEAR(glm::distance(tan_of(gaze.true_at(at(at_ms))), tan), 0.0, 1e-12) << at_ms;
    EXPECT_NEAR(glm::distance(tan_of(gaze.known_at(at(at_ms + 50))), tan), 0.0, 1e-12) << at_ms;
  };
  expect(-10.0, {0.0, 0.0});
  expect(150.0, {0.2, 0.1});
  expect(200.0, {-1.0, 0.0});
  expect(250.0, {-1.0, 0.5});
  expect(1000.0, {-1.0, 1.0});
}

TEST(GazeMotion, AScriptWantsPlacesInTime) {
  EXPECT_THROW(GazeMotion({}, ms(0)), Error);
  EXPECT_THROW(GazeMotion({{at(2), {}}, {at(1), {}}}, ms(0)), Error);
}

TEST(GazeMotion, ATracesGazeRunsFromItsStartAndRepeatsWithIt) {
  const sim::PoseTrace trace = sim::generate_trace(
      {.motion = sim::Motion::stationary, .seconds = 1, .gaze = {.motion = sim::EyeMotion::saccades}});
  HeadMotion head(trace, sim::Interpolation::hermite, {}, 1, true, sim_time(250'000'000));
  GazeMotion gaze(head, ms(20));
  std::size_t hint = 0;
  const auto recorded = [&](double at_ms) { return trace.gaze_at(sim_time(0) + ms(at_ms), hint); };
  EXPECT_EQ(gaze.true_at(at(100)), recorded(350));
  EXPECT_EQ(gaze.known_at(at(100)), recorded(330));
  EXPECT_EQ(gaze.true_at(at(1000)), recorded(250)) << "a turn later";
}

/// What a cast is told is what was known at its start; what a vsync shows is judged by the truth at its
/// photons.
class SeenGaze final : public FrameWork {
 public:
  JobOutcome update(const UpdateRequest&) override { return {}; }
  JobOutcome cast(const CastRequest& request) override {
    told.push_back({request.start, tan_of(request.gaze)});
    return {.work = {.samples = 1}};
  }
  JobOutcome warp(const WarpRequest&) override { return {}; }
  void show(const ShowRequest& request) override { truth.push_back(tan_of(request.true_gaze)); }
  struct Told {
    SimTime start;
    glm::dvec2 tan;
  };
  std::vector<Told> told;
  std::vector<glm::dvec2> truth;
};

TEST(GazeMotion, TheLoopTellsCastsWhatIsKnownAndRecordsTheTruthAtThePhotons) {
  Rig rig;
  SeenGaze work;
  rig.work = &work;
  // A tangent of one per second to the right.
  GazeMotion gaze({{SimTime(), {0.0, 0.0}}, {at(4000), {4.0, 0.0}}}, ms(30));
  rig.gaze = &gaze;
  const RunRecords records = rig.run(3.0, 1.0);
  for (const SeenGaze::Told& told : work.told)
    ASSERT_NEAR(told.tan.x, std::max(to_s(told.start) - 0.030, 0.0), 1e-9);
  int judged = 0;
  for (const FrameRecord& record : records.frames()) {
    if (record.displayed_frame < 0) {
      ASSERT_TRUE(std::isnan(record.gaze_x));
      continue;
    }
    const double truth = static_cast<double>(record.photon_mid_ns) * 1e-9;
    ASSERT_NEAR(record.gaze_x, truth, 1e-9);
    const double known = work.told[static_cast<std::size_t>(record.displayed_frame)].tan.x;
    ASSERT_NEAR(record.gaze_error_rad, std::atan(truth) - std::atan(known), 1e-9);
    ASSERT_NEAR(work.truth[static_cast<std::size_t>(judged++)].x, truth, 1e-9);
  }
  EXPECT_GT(judged, 100);
  rig.gaze = nullptr;
  const RunRecords without = rig.run(3.0, 1.0);
  for (const FrameRecord& record : without.frames())
    ASSERT_TRUE(std::isnan(record.gaze_x) && std::isnan(record.gaze_error_rad));
}

}  // namespace
}  // namespace brace
