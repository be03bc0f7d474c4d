#include "runtime/replay/headset.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

Session::Device wanted(const std::string& profile) {
  Session::Device device;
  device.profile = profile;
  device.render_target = "panel";
  device.lens = "profile";
  device.tracker = "profile";
  return device;
}

std::string error_of(const Session::Device& device) {
  try {
    make_headset(device, BRACE_DATA_DIR);
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
    return e.what();
  }
  return "";
}

TEST(HeadsetSetUp, FullScaleHasThePanelOfTheProfile) {
  const Headset vive = make_headset(wanted("htc-vive"), BRACE_DATA_DIR);
  EXPECT_EQ(vive.panel.width_px, 1080);
  EXPECT_EQ(vive.panel.height_px, 1200);
  EXPECT_EQ(vive.eye.width_px, vive.panel.width_px);
  EXPECT_EQ(vive.eye.height_px, vive.panel.height_px);
}

TEST(HeadsetSetUp, ScaleIsPerAxisAndRoundedToTheNearestPixel) {
  for (const double scale : {0.01, 0.05, 0.25, 1.0 / 3.0, 0.999, 1.5, 4.0}) {
    Session::Device device = wanted("htc-vive");
    device.resolution_scale = scale;
    const Headset headset = make_headset(device, BRACE_DATA_DIR);
    EXPECT_EQ(headset.panel.width_px, std::lround(1080 * scale)) << scale;
    EXPECT_EQ(headset.panel.height_px, std::lround(1200 * scale)) << scale;
  }
}

TEST(HeadsetSetUp, ScaleLeavesTheProfileItselfAlone) {
  Session::Device device = wanted("htc-vive");
  device.resolution_scale = 0.05;
  const Headset headset = make_headset(device, BRACE_DATA_DIR);
  EXPECT_EQ(headset.profile.panel_width_px, 1080);  // scan-out and photon times are the full panel's
  EXPECT_EQ(display_of(headset.profile).scan_out.direction, headset.profile.scan_out.direction);
}

TEST(HeadsetSetUp, RecommendedTargetChangesTheEyePicturesAloneWhereASourceGivesIt) {
  int given = 0;
  int not_given = 0;
  for (const sim::DeviceProfile& profile :
       sim::list_device_profiles(std::filesystem::path(BRACE_DATA_DIR) / "devices")) {
    Session::Device device = wanted(profile.name);
    device.lens = "none";
    device.render_target = "recommended";
    if (profile.target_width_px == 0) {
      EXPECT_THAT(error_of(device), HasSubstr(profile.name));
      ++not_given;
      continue;
    }
    const Headset headset = make_headset(device, BRACE_DATA_DIR);
    EXPECT_EQ(headset.eye.width_px, profile.target_width_px);
    EXPECT_EQ(headset.panel.width_px, profile.panel_width_px);
    ++given;
  }
  EXPECT_GT(given, 0);
  EXPECT_GT(not_given, 0);
}

TEST(HeadsetSetUp, WithoutALensEveryProfileIsUsableAndTheMappingIsTheIdentity) {
  for (const sim::DeviceProfile& profile :
       sim::list_device_profiles(std::filesystem::path(BRACE_DATA_DIR) / "devices")) {
    Session::Device device = wanted(profile.name);
    device.lens = "none";
    const Headset headset = make_headset(device, BRACE_DATA_DIR);
    for (const sim::EyeProfile& eye : headset.profile.eyes)
      EXPECT_TRUE(sim::lens_is_identity(eye.lens, eye.fov)) << profile.name;
  }
}

TEST(HeadsetSetUp, ADeviceWithoutLensDataIsRefusedWithTheWayOut) {
  int refused = 0;
  for (const sim::DeviceProfile& profile :
       sim::list_device_profiles(std::filesystem::path(BRACE_DATA_DIR) / "devices")) {
    const std::string message = error_of(wanted(profile.name));
    EXPECT_EQ(message.empty(), profile.has_lens_data()) << profile.name;
    if (message.empty()) continue;
    EXPECT_THAT(message, HasSubstr("lens"));
    EXPECT_THAT(message, HasSubstr("none"));
    ++refused;
  }
  EXPECT_GT(refused, 0);
}

TEST(HeadsetSetUp, AnUnknownProfileNamesThoseThatThereAre) {
  EXPECT_THAT(error_of(wanted("htc-viv")), testing::AllOf(HasSubstr("'htc-viv'"), HasSubstr("htc-vive-pro")));
  EXPECT_NE(error_of(wanted("../devices/htc-vive")), "");
  EXPECT_NE(error_of(wanted("")), "");
}

TEST(HeadsetSetUp, AnIdealTrackerHasNoLatencyNoiseOrDropOuts) {
  Session::Device device = wanted("htc-vive");
  device.tracker = "ideal";
  const sim::TrackerModel tracker = make_headset(device, BRACE_DATA_DIR).profile.tracker;
  EXPECT_EQ(tracker.latency, SimDuration(0));
  EXPECT_EQ(tracker.position_noise_m, 0.0);
  EXPECT_EQ(tracker.orientation_noise_rad, 0.0);
  EXPECT_EQ(tracker.dropout_probability, 0.0);
}

TEST(HeadsetSetUp, EyesStandAnIpdApartAcrossTheHead) {
  const Headset headset = make_headset(wanted("htc-vive"), BRACE_DATA_DIR);
  Pose world_from_head;
  world_from_head.position = {1.0, 2.0, 3.0};
  world_from_head.orientation = quat_exp({0.1, -0.7, 0.3});
  const EyeView left = eye_view(headset, sim::Eye::left, world_from_head);
  const EyeView right = eye_view(headset, sim::Eye::right, world_from_head);
  const glm::dvec3 between = right.world_from_eye.position - left.world_from_eye.position;
  EXPECT_NEAR(glm::length(between), headset.profile.ipd_m(), 1e-12);
  EXPECT_NEAR(glm::dot(glm::normalize(between), world_from_head.orientation * glm::dvec3(1, 0, 0)), 1.0,
              1e-12);
  EXPECT_EQ(left.width_px, headset.eye.width_px);
}

}  // namespace
}  // namespace brace
