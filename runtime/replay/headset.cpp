#include "runtime/replay/headset.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "hmd_sim/trace_generators.hpp"

namespace brace {

namespace {

PictureSize scaled(int width_px, int height_px, double scale) {
  const auto pixels = [scale](int full) { return std::max(1, static_cast<int>(std::lround(full * scale))); };
  return {pixels(width_px), pixels(height_px)};
}

std::filesystem::path shipped_trace(const std::string& name, const std::filesystem::path& data_folder) {
  std::vector<std::string> known;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder / "traces", ignored)) {
    if (entry.path().extension() != ".trace") continue;
    if (entry.path().stem() == name) return entry.path();
    known.push_back(entry.path().stem().string());
  }
  std::sort(known.begin(), known.end());
  throw input_error("trace.file = '{}': no shipped trace of this name{}; accepted: a path, or one of: {}",
                    name, did_you_mean(name, known), join(known));
}

/// "+z" as a unit vector of the volume's axes.
glm::dvec3 axis(const std::string& name) {
  glm::dvec3 v(0.0);
  v[name[1] - 'x'] = name[0] == '-' ? -1.0 : 1.0;
  return v;
}

}  // namespace

Headset make_headset(const Session::Device& device, const std::filesystem::path& data_folder) {
  Headset headset{sim::find_device_profile(data_folder / "devices", device.profile), {}, {}};
  sim::DeviceProfile& profile = headset.profile;
  if (device.lens == "none") {
    for (sim::EyeProfile& eye : profile.eyes)
      eye.lens = sim::identity_lens(eye.fov);
    profile.lens_kind = sim::LensKind::identity;
  } else {
    sim::require_lens_data(profile);
  }
  if (device.tracker == "ideal") profile.tracker = sim::TrackerModel{};
  const bool recommended = device.render_target == "recommended";
  if (recommended && profile.target_width_px == 0) {
    throw input_error(
        "device.render_target = 'recommended': no source gives it for {}; accepted here: 'panel'",
        profile.name);
  }
  const double scale = device.resolution_scale;
  headset.panel = scaled(profile.panel_width_px, profile.panel_height_px, scale);
  headset.eye =
      recommended ? scaled(profile.target_width_px, profile.target_height_px, scale) : headset.panel;
  return headset;
}

Headset make_headset(const Session& session, const std::filesystem::path& data_folder) {
  Headset headset = make_headset(session.device, data_folder);
  headset.distort_always = session.plan.keeps_idle("distortion");
  headset.fetch_channels_always = session.plan.keeps_idle("chromatic_channels");
  const auto refuse = [&](const char* item, const char* what) {
    throw input_error(
        "{}: 'plan.leave_out' names {}, but {} of {}: without it another headset would be simulated; "
        "accepted "
        "here: device.lens = \"none\", or another item",
        session.file.string(), item, what, headset.profile.name);
  };
  for (const std::string& item : session.plan.leave_out) {
    if (item == "distortion" && !lens_does_nothing(headset))
      refuse("distortion", "the lens bends the picture");
    if (item == "chromatic_channels" && !channels_equal(headset))
      refuse("chromatic_channels", "the lens is another one for each colour channel");
  }
  return headset;
}

bool lens_does_nothing(const Headset& headset) {
  const auto& eyes = headset.profile.eyes;
  return std::all_of(eyes.begin(), eyes.end(),
                     [](const sim::EyeProfile& eye) { return sim::lens_is_identity(eye.lens, eye.fov); });
}

bool channels_equal(const Headset& headset) {
  const auto& eyes = headset.profile.eyes;
  return std::all_of(eyes.begin(), eyes.end(),
                     [](const sim::EyeProfile& eye) { return sim::lens_channels_equal(eye.lens); });
}

Display display_of(const sim::DeviceProfile& profile) {
  return {profile.refresh, profile.scan_out, profile.emission, profile.scan_lines()};
}

PanelEye panel_eye(const Headset& headset, sim::Eye eye) {
  const sim::EyeProfile& profile = headset.profile.eye(eye);
  const sim::ScanDirection direction = headset.profile.scan_out.direction;
  return {headset.panel.width_px, headset.panel.height_px, profile.lens, profile.fov,
          sim::scan_fraction(direction, display_of(headset.profile).scan_lines)};
}

SourcePicture source_picture(const Headset& headset, sim::Eye eye) {
  return {headset.eye.width_px, headset.eye.height_px, headset.profile.eye(eye).fov};
}

EyeView eye_view(const Headset& headset, sim::Eye eye, const Pose& world_from_head) {
  const sim::EyeProfile& profile = headset.profile.eye(eye);
  EyeView view;
  view.world_from_eye = compose(world_from_head, profile.head_from_eye);
  view.tan_left = profile.fov.left;
  view.tan_right = profile.fov.right;
  view.tan_bottom = profile.fov.bottom;
  view.tan_top = profile.fov.top;
  view.width_px = headset.eye.width_px;
  view.height_px = headset.eye.height_px;
  return view;
}

HeadTrace load_head_trace(const Session::Trace& trace, const std::filesystem::path& data_folder) {
  if (trace.neck) {
    sim::MotionSpec spec;
    spec.motion = sim::parse_motion(trace.neck->motion == "still" ? "stationary" : trace.neck->motion);
    spec.degrees = trace.neck->degrees;
    spec.degrees_per_s = trace.neck->degrees;
    spec.metres = trace.neck->metres;
    spec.seconds = trace.neck->seconds;
    spec.seed = trace.neck->seed;
    sim::PoseTrace generated = sim::generate_trace(spec);
    sim::TraceRepairs repairs;
    repairs.poses_read = repairs.poses_kept = generated.poses().size();
    return {std::move(generated), repairs, "generated: " + trace.neck->motion};
  }
  const std::filesystem::path file =
      trace.file.is_absolute() ? trace.file : shipped_trace(trace.file.string(), data_folder);
  sim::TraceReadResult read = sim::read_trace(file, {.strict = trace.strict});
  std::string name = read.trace.name();
  return {std::move(read.trace), read.repairs, std::move(name)};
}

VolumePlacement place_volume(const Session::Scene& scene, const Pose& first_pose) {
  // Columns: where the volume's x, y and z axes point in a frame with +Y up and +Z towards the viewer.
  const glm::dvec3 up = axis(scene.up);
  const glm::dvec3 front = axis(scene.front);
  const glm::dvec3 right = glm::cross(up, front);
  const glm::dmat3 volume_from_upright(right, up, front);
  const glm::dquat upright_from_volume = glm::quat_cast(glm::transpose(volume_from_upright));

  VolumePlacement placement;
  placement.size_m = scene.size_m;
  double x = 0.0, y = 0.0, z = 0.0;
  if (std::sscanf(scene.position.c_str(), "front:%lf", &z) == 1) {
    glm::dvec3 forward = first_pose.orientation * glm::dvec3(0.0, 0.0, -1.0);
    forward.y = 0.0;
    // A head that looks straight up or down has no heading: take the world's.
    forward = glm::length(forward) < 1e-6 ? glm::dvec3(0.0, 0.0, -1.0) : glm::normalize(forward);
    const double yaw_rad = std::atan2(-forward.x, -forward.z);
    placement.world_from_volume.position = first_pose.position + z * forward;
    placement.world_from_volume.orientation = quat_exp({0.0, yaw_rad, 0.0}) * upright_from_volume;
    return placement;
  }
  BRACE_CHECK(std::sscanf(scene.position.c_str(), "%lf,%lf,%lf", &x, &y, &z) == 3);
  placement.world_from_volume.position = {x, y, z};
  placement.world_from_volume.orientation = upright_from_volume;
  return placement;
}

}  // namespace brace
