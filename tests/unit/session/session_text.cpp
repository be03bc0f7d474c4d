#include "tests/unit/session/session_text.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace::test {

namespace {

StageInfo stage(const std::string& family, const std::string& name) {
  StageInfo info;
  info.family = family;
  info.name = name;
  return info;
}

StageInfo stage_with_parameters() {
  StageInfo grid = stage("warp", "grid");
  grid.parameters = {
      {"cells", ParameterType::integer, "", "cells along an edge", 1.0, 256.0, 16.0, {}},
      {"far_plane_m", ParameterType::floating, "m", "where the picture stands", 0.5, 100.0, 10.0, {}},
      {"smooth", ParameterType::boolean, "", "bilinear", 0.0, 1.0, 1.0, {}},
      {"order", ParameterType::choice, "", "of the grid", 0.0, 2.0, 1.0, {"flat", "linear", "cubic"}}};
  return grid;
}

StageInfo stage_by_line() {
  StageInfo by_line = stage("warp", "by_line");
  by_line.parameters = {
      {"scan_out", ParameterType::choice, "", "of the panel", 0.0, 1.0, 0.0, {"middle", "lines"}}};
  return by_line;
}

/// rays/mab as far as its levels go.
StageInfo stage_with_levels() {
  StageInfo mab = stage("rays", "mab");
  mab.parameters.push_back({"levels", ParameterType::integer, "", "", 1.0, 8.0, 4.0, {}});
  for (int i = 0; i < 8; ++i) {
    mab.parameters.push_back(
        {"scale_" + std::to_string(i), ParameterType::floating, "", "", 0.001, 1.0, 0.9 - 0.1 * i, {}});
    if (i > 0)
      mab.parameters.push_back(
          {"anchor_" + std::to_string(i), ParameterType::floating, "", "", 0.0, 1.0, 0.1 + 0.1 * i, {}});
  }
  return mab;
}

}  // namespace

StageRegistry session_stages() {
  StageRegistry stages;
  for (const auto& [family, name] :
       std::vector<std::pair<const char*, const char*>>{{"rays", "full_rate"},
                                                        {"cast", "dvr"},
                                                        {"skip", "none"},
                                                        {"stereo", "two_pass"},
                                                        {"schedule", "whole_frame"},
                                                        {"warp", "none"},
                                                        {"warp", "quad"},
                                                        {"control", "fixed"},
                                                        {"predict", "none"},
                                                        {"predict", "constant_rate"}}) {
    stages.add(stage(family, name));
  }
  stages.add(stage_with_parameters());
  stages.add(stage_with_levels());
  stages.add(stage_by_line());
  return stages;
}

Session parse(const std::string& text, const Overrides& overrides) {
  return parse_session(text, "s.toml", "/sessions", overrides, session_stages());
}

std::string error_of(const std::string& text, const Overrides& overrides) {
  try {
    parse(text, overrides);
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
    EXPECT_STRNE(e.what(), "");
    return e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << "no input error but: " << e.what();
  }
  return "";
}

}  // namespace brace::test
