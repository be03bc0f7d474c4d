#pragma once

#include <filesystem>
#include <string>

#include "hmd_sim/device_profile.hpp"
#include "hmd_sim/trace_io.hpp"
#include "runtime/display/display_geometry.hpp"
#include "runtime/frame/frame_loop.hpp"
#include "runtime/raycast/eye_view.hpp"
#include "runtime/session/session.hpp"

namespace brace {

struct PictureSize {
  int width_px = 0;
  int height_px = 0;
};

/// The simulated headset of a session: its profile, with the session's scale and choices applied.
struct Headset {
  sim::DeviceProfile profile;
  PictureSize eye;                                             // the pictures that the raycaster makes
  PictureSize panel;                                           // what an eye's panel shows
  bool distort_always = false, fetch_channels_always = false;  // even where that does nothing
};

/// Throws input_error for an unknown profile, and for one without lens data unless device.lens = "none".
Headset make_headset(const Session::Device& device, const std::filesystem::path& data_folder);

/// With what the session's [plan] says of the display. Throws input_error where it leaves out what the
/// headset needs.
Headset make_headset(const Session& session, const std::filesystem::path& data_folder);

/// Whether no eye's lens moves anything; whether no eye's lens tells the colour channels apart.
bool lens_does_nothing(const Headset& headset);
bool channels_equal(const Headset& headset);

Display display_of(const sim::DeviceProfile& profile);

/// An eye's panel, and the eye frame that is shown on it, at the session's resolution.
PanelEye panel_eye(const Headset& headset, sim::Eye eye);
SourcePicture source_picture(const Headset& headset, sim::Eye eye);

EyeView eye_view(const Headset& headset, sim::Eye eye, const Pose& world_from_head);

/// The session's head motion: read from a file, from the shipped traces, or generated.
struct HeadTrace {
  sim::PoseTrace trace;
  sim::TraceRepairs repairs;
  std::string description;  // for the report
};
HeadTrace load_head_trace(const Session::Trace& trace, const std::filesystem::path& data_folder);

/// Where the volume stands: centred at the session's position, its `up` axis to the world's +Y. "front:D" is
/// D metres before `first_pose` at eye height, facing it; "x,y,z" faces +Z.
VolumePlacement place_volume(const Session::Scene& scene, const Pose& first_pose);

}  // namespace brace
