#include "hmd_sim/device_profile.hpp"

#include <fstream>
#include <sstream>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/error.hpp"

namespace brace::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path folder = std::filesystem::path(BRACE_SOURCE_DIR) / "hmd_sim/profiles";

std::string file_text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// The message of loading htc-vive.toml with one text replaced; "" if it loads.
std::string error_after(const std::string& from, const std::string& to,
                        const std::string& base = "htc-vive") {
  std::string text = file_text(folder / (base + ".toml"));
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("brace_edited_profile_" + std::to_string(getpid()) + ".toml");
  std::ofstream(path) << text;
  try {
    load_device_profile(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

TEST(DeviceProfile, ViveIsReadFromItsFile) {
  const DeviceProfile vive = find_device_profile(folder, "htc-vive");
  EXPECT_EQ(vive.name, "htc-vive");
  EXPECT_EQ(vive.display_name, "HTC Vive");
  EXPECT_EQ(vive.panel_width_px, 1080);
  EXPECT_EQ(vive.panel_height_px, 1200);
  EXPECT_EQ(vive.refresh.num, 90);
  EXPECT_EQ(vive.lens_kind, LensKind::vive);
  EXPECT_EQ(vive.scan_lines(), 1200);
  EXPECT_TRUE(vive.is_assumed("scan_out.fraction"));
  EXPECT_TRUE(vive.is_assumed("tracker.latency_ns"));  // its whole table is
  EXPECT_FALSE(vive.is_assumed("panel.width_px"));
  EXPECT_FALSE(vive.is_assumed("eyes.left.fov_tangents"));
}

TEST(DeviceProfile, AllNamedDevicesAreThere) {
  const std::vector<DeviceProfile> profiles = list_device_profiles(folder);
  std::vector<std::string> names;
  for (const DeviceProfile& profile : profiles)
    names.push_back(profile.name);
  for (const char* name : {"oculus-dk1", "oculus-dk2", "oculus-cv1", "htc-vive", "htc-vive-pro",
                           "valve-index", "quest-3", "quest-pro", "rift-s", "psvr2", "psvr", "osvr-hdk-1.3",
                           "osvr-hdk-2", "cardboard-v1", "cardboard-v2"}) {
    EXPECT_THAT(names, testing::Contains(name));
  }
}

TEST(DeviceProfile, EveryAssumedValueIsMarkedAtItsLine) {
  for (const DeviceProfile& profile : list_device_profiles(folder)) {
    const std::string text = file_text(folder / (profile.name + ".toml"));
    std::size_t marks = 0;
    for (std::size_t at = 0; (at = text.find("# assumed", at)) != std::string::npos; ++at)
      ++marks;
    EXPECT_EQ(marks, profile.assumed.size()) << profile.name;
  }
}

TEST(DeviceProfile, CantedEyesOfTheIndexLookOutwards) {
  const DeviceProfile index = find_device_profile(folder, "valve-index");
  const glm::dvec3 left_forward = index.eye(Eye::left).head_from_eye.orientation * glm::dvec3(0, 0, -1);
  // The rotation matrix of the source has -sin(5 degrees) there.
  EXPECT_NEAR(left_forward.x, -0.087156, 1e-6);
  EXPECT_NEAR(left_forward.z, -0.996195, 1e-6);
}

TEST(DeviceProfile, UnknownDeviceNamesTheNearest) {
  try {
    find_device_profile(folder, "htc-viv");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("htc-viv"), HasSubstr("did you mean 'htc-vive'"), HasSubstr("quest-3")));
  }
  EXPECT_THROW(list_device_profiles(folder / "nowhere"), Error);
  EXPECT_THROW(load_device_profile(folder / "nowhere.toml"), Error);
}

TEST(DeviceProfile, ErrorsNameFileLineAndKey) {
  EXPECT_EQ(error_after("width_px = 1080", "width_px = 1080"), "");
  EXPECT_THAT(
      error_after("width_px = 1080", "widht_px = 1080"),
      AllOf(HasSubstr("brace_edited_profile_"), HasSubstr("panel.widht_px"), HasSubstr("'width_px'")));
  EXPECT_THAT(error_after("refresh_hz = [90, 1]", ""),
              AllOf(HasSubstr("panel.refresh_hz"), HasSubstr("missing")));
  EXPECT_THAT(error_after("refresh_hz = [90, 1]", "refresh_hz = 90"), HasSubstr("panel.refresh_hz"));
  EXPECT_THAT(error_after("refresh_hz = [90, 1]", "refresh_hz = [90, 0]"), HasSubstr("panel.refresh_hz"));
  EXPECT_THAT(error_after("width_px = 1080", "width_px = -3"), HasSubstr("whole number from 1"));
  EXPECT_THAT(error_after("fraction = 0.985222", "fraction = 1.5"), HasSubstr("scan_out.fraction"));
  EXPECT_THAT(error_after("fraction = 0.985222", "fraction = nan"), HasSubstr("scan_out.fraction"));
  EXPECT_THAT(error_after("\"top_to_bottom\"", "\"top_to_botom\""),
              HasSubstr("did you mean 'top_to_bottom'"));
  EXPECT_THAT(error_after("kind = \"vive\"", "kind = \"fisheye\""), HasSubstr("brown_conrady"));
  EXPECT_THAT(error_after("{ left = -1.395577", "{ left = 1.395577"),
              HasSubstr("eyes.left.fov_tangents.left"));
  EXPECT_THAT(error_after("red = [", "red = [0, 0, "), HasSubstr("lens.left.red"));
  EXPECT_THAT(error_after("\"scan_out.fraction\" =", "\"scan_out.fractoin\" ="),
              HasSubstr("scan_out.fractoin"));
}

TEST(DeviceProfile, ALensThatFoldsAtItsCentreIsRefused) {
  EXPECT_THAT(error_after("rgb = [0.819,", "rgb = [-0.819,", "oculus-cv1"), HasSubstr("folds over"));
}

TEST(DeviceProfile, ADeviceWithoutLensDataSaysWhatToDo) {
  EXPECT_NO_THROW(require_lens_data(find_device_profile(folder, "htc-vive")));
  try {
    require_lens_data(find_device_profile(folder, "quest-3"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), AllOf(HasSubstr("quest-3"), HasSubstr("lens"), HasSubstr("device.lens")));
  }
}

}  // namespace
}  // namespace brace::sim
