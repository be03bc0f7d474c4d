#include "hmd_sim/trace_reader.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "hmd_sim/text_fields.hpp"

namespace brace::sim {
namespace {

constexpr const char* accepted_formats =
    "accepted: brace ('# brace pose trace 1'), TUM text (timestamp_s tx ty tz qx qy qz qw), EuRoC CSV "
    "(timestamp_ns, px, py, pz, qw, qx, qy, qz, …), A-Frame motion-capture JSON; the first two with gaze_x "
    "gaze_y gaze_z at the end of each line, too";

TraceFormat detect_format(const std::string& text, const std::string& name) {
  if (text.starts_with(brace_trace_magic)) return TraceFormat::brace;
  LineReader lines(text);
  while (const auto line = lines.next()) {
    const std::string_view content = trimmed(*line);
    if (content.empty() || content.front() == '#') continue;
    if (content.front() == '{' || content.front() == '[') return TraceFormat::aframe;
    const std::size_t commas = split_fields(content, ',').size();
    if (commas >= 8 && parse_number(split_fields(content, ',')[0])) return TraceFormat::euroc;
    const std::size_t words = split_words(content).size();
    if (commas == 1 && (words == 8 || words == 11)) return TraceFormat::tum;
    throw input_error("{}:{}: not a pose trace of a known format; {}", name, lines.line(), accepted_formats);
  }
  throw input_error("{}: empty, no pose in it; {}", name, accepted_formats);
}

RawTrace parse_as(TraceFormat format, const std::string& text, const std::string& name) {
  switch (format) {
    case TraceFormat::brace:
      return parse_brace(text, name);
    case TraceFormat::tum:
      return parse_tum(text, name);
    case TraceFormat::euroc:
      return parse_euroc(text, name);
    case TraceFormat::aframe:
      return parse_aframe(text, name);
  }
  throw input_error("{}: unknown trace format", name);
}

// Turns raw poses into valid ones; the first pose it would drop is an error in a strict read.
class Repairer {
 public:
  Repairer(std::string name, std::string place_word, bool has_gaze, bool strict)
      : name_(std::move(name)), place_word_(std::move(place_word)), has_gaze_(has_gaze), strict_(strict) {}

  void add(const RawPose& raw) {
    ++repairs.poses_read;
    const glm::dquat& q = raw.orientation;
    const glm::dvec3& p = raw.position;
    if (!raw.time_is_finite || !std::isfinite(glm::dot(p, p)) || !std::isfinite(q.x + q.y + q.z + q.w)) {
      return drop(repairs.dropped_non_finite, raw, "NaN or infinity");
    }
    const double length = std::sqrt(glm::dot(q, q));
    if (std::abs(length - 1.0) > 1e-2) {
      return drop(repairs.dropped_bad_quaternion, raw,
                  fmt::format("quaternion of length {:.6g}, not 1", length));
    }
    if (!poses.empty() && raw.time <= poses.back().time) {
      return drop(repairs.dropped_time, raw,
                  fmt::format("time {} ns is not later than the one before it, {} ns", to_ns(raw.time),
                              to_ns(poses.back().time)));
    }
    keep(raw, length);
  }

  std::vector<TimedPose> poses;
  std::vector<glm::dvec3> gaze;
  TraceRepairs repairs;

 private:
  void keep(const RawPose& raw, double length) {
    TimedPose pose{raw.time, {raw.orientation, raw.position}};
    if (std::abs(length - 1.0) > 1e-9) {
      pose.world_from_head.orientation = raw.orientation * (1.0 / length);
      ++repairs.renormalised;
    }
    if (!poses.empty()) {
      const TimedPose& last = poses.back();
      if (glm::dot(last.world_from_head.orientation, pose.world_from_head.orientation) < 0.0) {
        pose.world_from_head.orientation = -pose.world_from_head.orientation;
        ++repairs.sign_flips;
      }
      if (pose.time - last.time > trace_gap) ++repairs.gaps;
    }
    poses.push_back(pose);
    ++repairs.poses_kept;
    if (has_gaze_) keep_gaze(raw);
  }

  void keep_gaze(const RawPose& raw) {
    ++repairs.gaze_read;
    const double length = glm::length(raw.gaze);
    gaze.push_back(std::abs(length - 1.0) > 1e-9 ? raw.gaze / length : raw.gaze);
    if (std::isnan(length)) {
      ++repairs.gaze_lost;
    } else if (!(std::abs(length - 1.0) <= 1e-2) || !(raw.gaze.z < 0.0)) {
      drop(repairs.gaze_bad, raw,
           fmt::format("gaze ({:.6g}, {:.6g}, {:.6g}) is no unit vector that looks ahead (z < 0)", raw.gaze.x,
                       raw.gaze.y, raw.gaze.z));
      gaze.back() = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    }
  }

  void drop(std::size_t& counter, const RawPose& raw, const std::string& what) {
    const std::string where = place_word_ == "line" ? fmt::format("{}:{}", name_, raw.place)
                                                    : fmt::format("{}: {} {}", name_, place_word_, raw.place);
    const std::string problem = fmt::format("{}: {}", where, what);
    if (strict_) throw input_error("{} (strict: nothing is repaired)", problem);
    if (repairs.first_problem.empty()) repairs.first_problem = problem;
    ++counter;
  }

  std::string name_, place_word_;
  bool has_gaze_, strict_;
};

std::string read_text(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw input_error("{}: is a folder; a pose trace is wanted", path.string());
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw input_error("{}: cannot be opened: no such file, or not readable", path.string());
  std::ostringstream text;
  text << stream.rdbuf();
  if (stream.bad()) throw input_error("{}: reading failed", path.string());
  return text.str();
}

std::string trace_name(const std::string& name) {
  return std::filesystem::path(name).stem().string();
}

}  // namespace

TraceReadResult parse_trace(const std::string& text, const std::string& name,
                            const TraceReadOptions& options) {
  const TraceFormat format = detect_format(text, name);
  const RawTrace raw = parse_as(format, text, name);
  Repairer repairer(name, raw.place_word, raw.has_gaze, options.strict);
  for (const RawPose& pose : raw.poses)
    repairer.add(pose);
  if (repairer.poses.size() < 2) {
    const std::string& problem = repairer.repairs.first_problem;
    throw input_error("{}: {} valid pose{} of {} read; a trace needs at least two{}{}", name,
                      repairer.poses.size(), repairer.poses.size() == 1 ? "" : "s", raw.poses.size(),
                      problem.empty() ? "" : "; first problem: ", problem);
  }
  return {PoseTrace(trace_name(name), std::move(repairer.poses), std::move(repairer.gaze)),
          std::move(repairer.repairs), format};
}

TraceReadResult read_trace(const std::filesystem::path& path, const TraceReadOptions& options) {
  return parse_trace(read_text(path), path.string(), options);
}

std::string describe(const TraceRepairs& repairs) {
  std::string text = fmt::format("{} poses", repairs.poses_kept);
  if (repairs.dropped() > 0) text += fmt::format(" of {}", repairs.poses_read);
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(repairs.dropped_non_finite, "dropped for NaN or infinity");
  add(repairs.dropped_bad_quaternion, "dropped for a quaternion that is not unit");
  add(repairs.dropped_time, "dropped for a time that is not later");
  add(repairs.renormalised, "quaternions renormalised");
  add(repairs.sign_flips, "quaternion signs flipped");
  add(repairs.gaps, "gaps > 50 ms marked invalid");
  add(repairs.gaze_lost, "gaze readings lost (the last one holds)");
  add(repairs.gaze_bad, "gaze readings that are no unit vector ahead, taken as lost");
  const bool clean = repairs.dropped() + repairs.renormalised + repairs.sign_flips + repairs.gaps +
                         repairs.gaze_lost + repairs.gaze_bad ==
                     0;
  if (clean) text += ", nothing repaired";
  if (!repairs.first_problem.empty()) text += fmt::format("; first: {}", repairs.first_problem);
  return text;
}

}  // namespace brace::sim
