#include <array>
#include <span>

#include "base/error.hpp"
#include "hmd_sim/text_fields.hpp"
#include "hmd_sim/trace_reader.hpp"

namespace brace::sim {
namespace {

using Fields = std::vector<std::string_view>;

// Seven numbers of a pose from fields[1 ..]; throws naming file, line and field.
std::array<double, 7> pose_numbers(const Fields& fields, const std::string& name, std::size_t line) {
  std::array<double, 7> numbers{};
  for (std::size_t i = 0; i < 7; ++i) {
    const auto number = parse_number(fields[i + 1]);
    if (!number) {
      throw input_error("{}:{}: field {} '{}' is not a number", name, line, i + 2, fields[i + 1]);
    }
    numbers[i] = *number;
  }
  return numbers;
}

std::int64_t integer_time(std::string_view field, const std::string& name, std::size_t line) {
  const auto ns = parse_integer(field);
  if (!ns || *ns > time_ns_max || *ns < -time_ns_max) {
    throw input_error("{}:{}: time '{}' is not a whole number of nanoseconds within 146 years", name, line,
                      field);
  }
  return *ns;
}

void require_fields(const Fields& fields, std::size_t least, std::size_t most, const std::string& name,
                    std::size_t line, const char* what) {
  if (fields.size() < least || fields.size() > most) {
    throw input_error("{}:{}: {} fields; {} are wanted", name, line, fields.size(), what);
  }
}

template <typename ReadLine>
RawTrace parse_lines(const std::string& text, ReadLine read_line) {
  RawTrace trace;
  trace.place_word = "line";
  LineReader lines(text);
  while (const auto line = lines.next()) {
    const std::string_view content = trimmed(*line);
    if (content.empty() || content.front() == '#') continue;
    RawPose pose = read_line(content, lines.line());
    pose.place = lines.line();
    trace.poses.push_back(pose);
  }
  return trace;
}

RawPose with_xyzw(std::span<const double, 7> n) {
  RawPose pose;
  pose.position = {n[0], n[1], n[2]};
  pose.orientation = glm::dquat(n[6], n[3], n[4], n[5]);
  return pose;
}

}  // namespace

RawTrace parse_brace(const std::string& text, const std::string& name) {
  return parse_lines(text, [&](std::string_view content, std::size_t line) {
    const Fields fields = split_words(content);
    require_fields(fields, 8, 8, name, line, "time_ns x y z qx qy qz qw");
    RawPose pose = with_xyzw(pose_numbers(fields, name, line));
    pose.time = sim_time(integer_time(fields[0], name, line));
    return pose;
  });
}

RawTrace parse_tum(const std::string& text, const std::string& name) {
  return parse_lines(text, [&](std::string_view content, std::size_t line) {
    const Fields fields = split_words(content);
    require_fields(fields, 8, 8, name, line, "timestamp_s tx ty tz qx qy qz qw");
    RawPose pose = with_xyzw(pose_numbers(fields, name, line));
    bool not_finite = false;
    const auto ns = parse_seconds_as_ns(fields[0], not_finite);
    if (!ns && !not_finite) {
      throw input_error("{}:{}: time '{}' is not a number of seconds within 146 years", name, line,
                        fields[0]);
    }
    pose.time_is_finite = ns.has_value();
    pose.time = sim_time(ns.value_or(0));
    return pose;
  });
}

RawTrace parse_euroc(const std::string& text, const std::string& name) {
  return parse_lines(text, [&](std::string_view content, std::size_t line) {
    const Fields fields = split_fields(content, ',');
    // 17 fields with velocity and biases, which a head trace does not need.
    require_fields(fields, 8, 17, name, line, "timestamp_ns, px, py, pz, qw, qx, qy, qz [, …]");
    const auto n = pose_numbers(fields, name, line);
    RawPose pose;
    pose.position = {n[0], n[1], n[2]};
    pose.orientation = glm::dquat(n[3], n[4], n[5], n[6]);
    pose.time = sim_time(integer_time(fields[0], name, line));
    return pose;
  });
}

}  // namespace brace::sim
