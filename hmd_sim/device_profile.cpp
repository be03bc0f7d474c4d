#include "hmd_sim/device_profile.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "base/suggest.hpp"

namespace brace::sim {

bool DeviceProfile::is_assumed(std::string_view key) const {
  if (assumed.contains(std::string(key))) return true;
  const std::size_t dot = key.rfind('.');
  return dot != std::string_view::npos && is_assumed(key.substr(0, dot));
}

double DeviceProfile::ipd_m() const {
  return glm::length(eye(Eye::right).head_from_eye.position - eye(Eye::left).head_from_eye.position);
}

int DeviceProfile::scan_lines() const {
  const bool sideways = scan_out.direction == ScanDirection::left_to_right ||
                        scan_out.direction == ScanDirection::right_to_left;
  return sideways ? panel_width_px : panel_height_px;
}

namespace {

std::vector<std::string> profile_names(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  if (error) throw input_error("{}: no folder of device profiles: {}", folder.string(), error.message());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

DeviceProfile find_device_profile(const std::filesystem::path& folder, std::string_view name) {
  const std::vector<std::string> names = profile_names(folder);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw input_error("unknown device profile '{}'{}; there are: {}", name, did_you_mean(name, names),
                      join(names));
  }
  return load_device_profile(folder / (std::string(name) + ".toml"));
}

std::vector<DeviceProfile> list_device_profiles(const std::filesystem::path& folder) {
  std::vector<DeviceProfile> profiles;
  for (const std::string& name : profile_names(folder)) {
    profiles.push_back(load_device_profile(folder / (name + ".toml")));
  }
  return profiles;
}

void require_lens_data(const DeviceProfile& profile) {
  if (profile.has_lens_data()) return;
  throw input_error(
      "device '{}' has no lens data: no source publishes its lens. Set device.lens = \"none\" to do "
      "without, or choose a device that has one (brace list devices)",
      profile.name);
}

}  // namespace brace::sim
