#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <ostream>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "hmd_sim/text_fields.hpp"
#include "hmd_sim/trace_io.hpp"

namespace brace::sim {
namespace {

constexpr std::array<TraceFormat, 4> all_formats{TraceFormat::brace, TraceFormat::tum, TraceFormat::euroc,
                                                 TraceFormat::aframe};

std::string decimal_seconds(std::int64_t ns) {
  const std::int64_t magnitude = std::abs(ns);
  return fmt::format("{}{}.{:09}", ns < 0 ? "-" : "", magnitude / 1'000'000'000, magnitude % 1'000'000'000);
}

std::string gaze_fields(const PoseTrace& trace, std::size_t i, char separator) {
  if (!trace.has_gaze()) return "";
  const glm::dvec3& g = trace.gaze()[i];
  return fmt::format("{0}{1:.17g}{0}{2:.17g}{0}{3:.17g}", separator, g.x, g.y, g.z);
}

std::string pose_line(const PoseTrace& trace, std::size_t i, TraceFormat format) {
  const TimedPose& pose = trace.poses()[i];
  const glm::dvec3& p = pose.world_from_head.position;
  const glm::dquat& q = pose.world_from_head.orientation;
  const std::int64_t ns = to_ns(pose.time);
  if (format == TraceFormat::euroc) {
    return fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}{}\n", ns, p.x, p.y, p.z,
                       q.w, q.x, q.y, q.z, gaze_fields(trace, i, ','));
  }
  return fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}{}\n",
                     format == TraceFormat::tum ? decimal_seconds(ns) : std::to_string(ns), p.x, p.y, p.z,
                     q.x, q.y, q.z, q.w, gaze_fields(trace, i, ' '));
}

void write_header(std::ostream& out, const PoseTrace& trace, TraceFormat format,
                  const std::vector<std::string>& notes) {
  if (format == TraceFormat::euroc) {
    out << "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []"
        << (trace.has_gaze() ? ",gaze_x [],gaze_y [],gaze_z []\n" : "\n");
    return;
  }
  if (format == TraceFormat::brace) out << brace_trace_magic << '\n';
  out << "# name: " << trace.name() << '\n';
  for (const std::string& note : notes)
    out << "# " << note << '\n';
  out << "# frame: OpenXR (right-handed, +X right, +Y up, -Z forward), world from head, metres, unit "
         "quaternion\n";
  if (trace.has_gaze()) out << "# gaze: unit vector in the head frame; nan: lost, a blink\n";
  out << (format == TraceFormat::tum ? "# timestamp_s tx ty tz qx qy qz qw" : "# time_ns x y z qx qy qz qw")
      << (trace.has_gaze() ? " gaze_x gaze_y gaze_z\n" : "\n");
}

}  // namespace

std::string to_string(TraceFormat format) {
  switch (format) {
    case TraceFormat::brace:
      return "brace";
    case TraceFormat::tum:
      return "tum";
    case TraceFormat::euroc:
      return "euroc";
    case TraceFormat::aframe:
      return "aframe";
  }
  return "unknown";
}

TraceFormat parse_trace_format(const std::string& name) {
  std::vector<std::string> names;
  for (const TraceFormat format : all_formats) {
    if (to_string(format) == name) return format;
    names.push_back(to_string(format));
  }
  throw input_error("unknown trace format '{}'{}; accepted: {}", name, did_you_mean(name, names),
                    join(names));
}

void write_trace(std::ostream& out, const PoseTrace& trace, TraceFormat format,
                 const std::vector<std::string>& notes) {
  if (format == TraceFormat::aframe) {
    throw input_error("the aframe format is read only; accepted for writing: brace, tum, euroc");
  }
  write_header(out, trace, format, notes);
  for (std::size_t i = 0; i < trace.poses().size(); ++i)
    out << pose_line(trace, i, format);
}

void write_trace(const std::filesystem::path& path, const PoseTrace& trace, TraceFormat format,
                 const std::vector<std::string>& notes) {
  if (format == TraceFormat::aframe) {
    throw input_error("{}: the aframe format is read only; accepted for writing: brace, tum, euroc",
                      path.string());
  }
  // Written beside the target and renamed, so that a full disk leaves no half file and harms no old one.
  std::filesystem::path partial = path;
  partial += ".partial";
  errno = 0;
  std::ofstream out(partial, std::ios::binary | std::ios::trunc);
  if (!out) throw input_error("{}: cannot be written: {}", path.string(), std::strerror(errno));
  write_trace(out, trace, format, notes);
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(partial, path, error);
  if (!out || error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw input_error("{}: writing failed: {}", path.string(),
                      error ? error.message() : std::strerror(errno));
  }
}

}  // namespace brace::sim
