#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.hpp"
#include "hmd_sim/lens.hpp"
#include "hmd_sim/tracker.hpp"
#include "hmd_sim/vsync.hpp"

namespace brace::sim {

enum class Eye { left = 0, right = 1 };
inline constexpr std::array<Eye, 2> all_eyes{Eye::left, Eye::right};

struct EyeProfile {
  FovTangents fov;
  Pose head_from_eye;  // half the IPD sideways, a canted display's turn about y
  EyeLens lens;        // mapping: see lens.hpp
};

/// A headset as data. Facts carry their source as comments in the profile's TOML file; what no source gives
/// is listed in `assumed`.
struct DeviceProfile {
  std::string name;          // "htc-vive", equals the file's stem
  std::string display_name;  // "HTC Vive"
  int panel_width_px = 0;    // of one eye
  int panel_height_px = 0;
  int target_width_px = 0;  // recommended render target of one eye; 0 if no source gives one
  int target_height_px = 0;
  Rate refresh;
  std::array<EyeProfile, 2> eyes;  // indexed by Eye
  LensKind lens_kind = LensKind::none_published;
  ScanOut scan_out;
  Emission emission;
  TrackerModel tracker;
  std::map<std::string, std::string> assumed;  // key as in the file ("scan_out.fraction") → why this value

  const EyeProfile& eye(Eye which) const { return eyes[static_cast<std::size_t>(which)]; }
  /// Whether a value is assumed rather than taken from a source; `key` as in the file, its table counts too.
  bool is_assumed(std::string_view key) const;
  bool has_lens_data() const { return lens_kind != LensKind::none_published; }
  double ipd_m() const;
  /// Lines in scan-out order of one eye's panel: rows, or columns where it scans sideways.
  int scan_lines() const;
};

// The file, by example of htc-vive.toml; tables render_target and assumed may be missing, every other key
// not:
//   display_name
//   [panel]          width_px, height_px (one eye), refresh_hz = [num, den], persistence_ns, photon_delay_ns
//   [render_target]  width_px, height_px (one eye)
//   [scan_out]       direction = "global|top_to_bottom|bottom_to_top|left_to_right|right_to_left", fraction
//   [eyes.left], [eyes.right]   fov_tangents = {left, right, bottom, top}, position_m (in the head),
//                    cant_deg (turn about +Y: positive turns the eye to the left)
//   [lens]           kind = "none_published|identity|brown_conrady|panotools|vive"; of the last three also
//   [lens.left], [lens.right]   panel_size_units = [w, h], tan_per_unit = [x, y], centre_uv = [u, v] or
//   centre_uv
//                    = {red, green, blue}; rgb = [k…] or red, green, blue = [k…]; scale_rgb = [r, g, b]
//                    (panotools: factors on all k of a channel); cutoff_radius
//   [tracker]        rate_hz = [num, den], latency_ns, position_noise_m, orientation_noise_rad,
//                    dropout_probability
//   [assumed]        "scan_out.fraction" = "why"

/// Reads one profile. Throws input_error naming file and key (exit code 2): missing or unknown key (with the
/// nearest known one), value out of range, lens that folds over at its centre.
DeviceProfile load_device_profile(const std::filesystem::path& path);

/// The profile called `name` in a folder; throws input_error that lists the names there if there is none.
DeviceProfile find_device_profile(const std::filesystem::path& folder, std::string_view name);

/// All profiles (*.toml) of a folder, by name.
std::vector<DeviceProfile> list_device_profiles(const std::filesystem::path& folder);

/// Throws input_error for a device whose lens no source gives; what to do instead is in the message.
void require_lens_data(const DeviceProfile& profile);

}  // namespace brace::sim
