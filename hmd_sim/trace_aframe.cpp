#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "hmd_sim/trace_reader.hpp"

namespace brace::sim {
namespace {

using Json = nlohmann::json;

Json parse_json(const std::string& text, const std::string& name) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& e) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(e.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw input_error("{}:{}: not valid JSON at byte {}; an A-Frame motion-capture recording is wanted", name,
                      line, e.byte);
  } catch (const Json::out_of_range&) {
    throw input_error(
        "{}: a number beyond the range of double; an A-Frame motion-capture recording is wanted", name);
  }
}

// A recording is {"camera": {"poses": […]}, …}; one of a single entity is {"poses": […]}.
const Json& pose_list(const Json& recording, const std::string& name) {
  const Json* entity = &recording;
  if (recording.is_object() && recording.contains("camera")) entity = &recording["camera"];
  if (entity->is_object() && entity->contains("poses") && (*entity)["poses"].is_array())
    return (*entity)["poses"];
  std::string keys;
  if (recording.is_object()) {
    for (const auto& [key, value] : recording.items())
      keys += (keys.empty() ? "" : ", ") + key;
  }
  throw input_error(
      "{}: no array 'camera.poses' in this JSON (keys: {}); an A-Frame motion-capture recording "
      "is wanted",
      name, keys.empty() ? "none" : keys);
}

// JSON has no NaN: recorders write null for it.
double number_at(const Json& object, const char* key, const std::string& name, std::size_t index) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (!object.is_object() || found == object.end()) {
    throw input_error("{}: pose {} lacks '{}'", name, index, key);
  }
  if (found->is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!found->is_number()) throw input_error("{}: pose {}: '{}' is not a number", name, index, key);
  return found->get<double>();
}

glm::dvec3 vector_at(const Json& pose, const char* key, const std::string& name, std::size_t index) {
  if (!pose.is_object() || !pose.contains(key)) throw input_error("{}: pose {} lacks '{}'", name, index, key);
  const Json& v = pose[key];
  return {number_at(v, "x", name, index), number_at(v, "y", name, index), number_at(v, "z", name, index)};
}

// three.js' Euler order YXZ: first about z, then x, then y (fixed axes), degrees.
glm::dquat from_euler_yxz(const glm::dvec3& degrees) {
  const glm::dvec3 half = degrees * (std::numbers::pi / 360.0);
  const glm::dquat about_x(std::cos(half.x), std::sin(half.x), 0, 0);
  const glm::dquat about_y(std::cos(half.y), 0, std::sin(half.y), 0);
  const glm::dquat about_z(std::cos(half.z), 0, 0, std::sin(half.z));
  return about_y * about_x * about_z;
}

}  // namespace

RawTrace parse_aframe(const std::string& text, const std::string& name) {
  const Json recording = parse_json(text, name);
  RawTrace trace;
  trace.place_word = "pose";
  for (const Json& entry : pose_list(recording, name)) {
    RawPose pose;
    pose.place = trace.poses.size() + 1;
    pose.position = vector_at(entry, "position", name, pose.place);
    pose.orientation = from_euler_yxz(vector_at(entry, "rotation", name, pose.place));
    const double time_ms = number_at(entry, "timestamp", name, pose.place);
    pose.time_is_finite = std::isfinite(time_ms);
    if (pose.time_is_finite && std::abs(time_ms) > 4.6e12) {
      throw input_error("{}: pose {}: timestamp {} ms is beyond 146 years", name, pose.place, time_ms);
    }
    pose.time = sim_time(pose.time_is_finite ? std::llround(time_ms * 1e6) : 0);
    trace.poses.push_back(pose);
  }
  return trace;
}

}  // namespace brace::sim
