#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "base/error.hpp"
#include "hmd_sim/gaze.hpp"
#include "hmd_sim/text_fields.hpp"
#include "hmd_sim/trace_reader.hpp"

namespace brace::sim {
namespace {

using Fields = std::vector<std::string_view>;

double number_in(const Fields& fields, std::size_t field, const std::string& name, std::size_t line) {
  const auto number = parse_number(fields[field]);
  if (!number)
    throw input_error("{}:{}: field {} '{}' is not a number", name, line, field + 1, fields[field]);
  return *number;
}

// Seven numbers of a pose from fields[1 ..]; throws naming file, line and field.
std::array<double, 7> pose_numbers(const Fields& fields, const std::string& name, std::size_t line) {
  std::array<double, 7> numbers{};
  for (std::size_t i = 0; i < 7; ++i)
    numbers[i] = number_in(fields, i + 1, name, line);
  return numbers;
}

// Words per line, the same in all of them: 8, or with gaze 11.
class WordCount {
 public:
  void check(const Fields& fields, const std::string& name, std::size_t line, const char* what) {
    const std::size_t words = fields.size();
    if (words != 8 && words != 11) {
      throw input_error("{}:{}: {} fields; {} [gaze_x gaze_y gaze_z] are wanted", name, line, words, what);
    }
    if (first_ == 0) first_ = words;
    if (words != first_) {
      throw input_error(
          "{}:{}: {} fields; as many as in the first pose, {}, are wanted: gaze is in all poses "
          "or in none ('nan nan nan' where it is lost)",
          name, line, words, first_);
    }
  }
  bool has_gaze() const { return first_ == 11; }

 private:
  std::size_t first_ = 0;
};

glm::dvec3 gaze_words(const Fields& fields, const std::string& name, std::size_t line) {
  return {number_in(fields, 8, name, line), number_in(fields, 9, name, line),
          number_in(fields, 10, name, line)};
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

// Columns of a CSV that its header names: three of a direction, or two of angles.
struct GazeColumns {
  std::vector<std::size_t> at;

  std::size_t fields_min() const {
    std::size_t least = 8;
    for (const std::size_t column : at)
      least = std::max(least, column + 1);
    return least;
  }

  glm::dvec3 read(const Fields& fields, const std::string& name, std::size_t line) const {
    std::array<double, 3> n{};
    for (std::size_t i = 0; i < at.size(); ++i) {
      const bool empty = fields[at[i]].empty();  // as eye trackers write what they have lost
      n[i] = empty ? std::numeric_limits<double>::quiet_NaN() : number_in(fields, at[i], name, line);
    }
    if (at.size() == 3) return {n[0], n[1], n[2]};
    return direction_of_angles(n[0], n[1]);
  }
};

// "gaze_x [rad]" -> "gaze_x"
std::string_view column_name(std::string_view field) {
  if (!field.empty() && field.front() == '#') field.remove_prefix(1);
  const std::vector<std::string_view> words = split_words(field);
  return words.empty() ? std::string_view() : words.front();
}

// From the last '#' line before the first pose.
GazeColumns find_gaze_columns(const std::string& text, const std::string& name) {
  LineReader lines(text);
  Fields header;
  while (const auto line = lines.next()) {
    const std::string_view content = trimmed(*line);
    if (!content.empty() && content.front() != '#') break;
    if (!content.empty()) header = split_fields(content, ',');
  }
  const auto place_of = [&](std::string_view wanted) {
    std::size_t i = 0;
    while (i < header.size() && column_name(header[i]) != wanted)
      ++i;
    return i;
  };
  for (const std::vector<std::string_view>& wanted :
       {std::vector<std::string_view>{"gaze_x", "gaze_y", "gaze_z"},
        std::vector<std::string_view>{"gaze_yaw", "gaze_pitch"}}) {
    GazeColumns columns;
    for (const std::string_view column : wanted)
      if (const std::size_t at = place_of(column); at < header.size()) columns.at.push_back(at);
    if (columns.at.empty()) continue;
    if (columns.at.size() < wanted.size()) {
      throw input_error(
          "{}: its header names some columns of gaze; wanted: gaze_x, gaze_y and gaze_z, or "
          "gaze_yaw and gaze_pitch",
          name);
    }
    if (*std::min_element(columns.at.begin(), columns.at.end()) < 8) {
      throw input_error("{}: its header names a column of gaze among the first eight, which are the pose",
                        name);
    }
    return columns;
  }
  return {};
}

RawPose with_xyzw(std::span<const double, 7> n) {
  RawPose pose;
  pose.position = {n[0], n[1], n[2]};
  pose.orientation = glm::dquat(n[6], n[3], n[4], n[5]);
  return pose;
}

}  // namespace

RawTrace parse_brace(const std::string& text, const std::string& name) {
  WordCount words;
  RawTrace trace = parse_lines(text, [&](std::string_view content, std::size_t line) {
    const Fields fields = split_words(content);
    words.check(fields, name, line, "time_ns x y z qx qy qz qw");
    RawPose pose = with_xyzw(pose_numbers(fields, name, line));
    if (words.has_gaze()) pose.gaze = gaze_words(fields, name, line);
    pose.time = sim_time(integer_time(fields[0], name, line));
    return pose;
  });
  trace.has_gaze = words.has_gaze();
  return trace;
}

RawTrace parse_tum(const std::string& text, const std::string& name) {
  WordCount words;
  RawTrace trace = parse_lines(text, [&](std::string_view content, std::size_t line) {
    const Fields fields = split_words(content);
    words.check(fields, name, line, "timestamp_s tx ty tz qx qy qz qw");
    RawPose pose = with_xyzw(pose_numbers(fields, name, line));
    if (words.has_gaze()) pose.gaze = gaze_words(fields, name, line);
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
  trace.has_gaze = words.has_gaze();
  return trace;
}

RawTrace parse_euroc(const std::string& text, const std::string& name) {
  const GazeColumns gaze = find_gaze_columns(text, name);
  RawTrace trace = parse_lines(text, [&](std::string_view content, std::size_t line) {
    const Fields fields = split_fields(content, ',');
    // 17 fields with velocity and biases, which a head trace does not need; gaze adds up to three.
    require_fields(fields, gaze.fields_min(), 20, name, line,
                   "timestamp_ns, px, py, pz, qw, qx, qy, qz [, …]");
    const auto n = pose_numbers(fields, name, line);
    RawPose pose;
    pose.position = {n[0], n[1], n[2]};
    pose.orientation = glm::dquat(n[3], n[4], n[5], n[6]);
    if (!gaze.at.empty()) pose.gaze = gaze.read(fields, name, line);
    pose.time = sim_time(integer_time(fields[0], name, line));
    return pose;
  });
  trace.has_gaze = !gaze.at.empty();
  return trace;
}

}  // namespace brace::sim
