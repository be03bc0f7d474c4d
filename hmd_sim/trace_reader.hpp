#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hmd_sim/trace_io.hpp"

namespace brace::sim {

// Between the parsers and the repair; not for use outside hmd_sim.

/// Times beyond +-146 years are refused, so that the difference of two fits 64 bits.
inline constexpr std::int64_t time_ns_max = 4'600'000'000'000'000'000;

/// One pose as a file states it: nothing checked yet.
struct RawPose {
  bool time_is_finite = true;
  SimTime time;
  glm::dvec3 position{0.0};
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
  std::size_t place = 0;  // line, or number of the pose in JSON; from 1
  glm::dvec3 gaze{0.0};   // where the trace has gaze
};

struct RawTrace {
  std::vector<RawPose> poses;
  std::string place_word;  // "line" or "pose": what `place` counts
  bool has_gaze = false;
};

RawTrace parse_brace(const std::string& text, const std::string& name);
RawTrace parse_tum(const std::string& text, const std::string& name);
RawTrace parse_euroc(const std::string& text, const std::string& name);
RawTrace parse_aframe(const std::string& text, const std::string& name);

}  // namespace brace::sim
