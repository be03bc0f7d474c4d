#pragma once

#include "plugins/abi/brace_stage.h"

namespace brace::stages {

// The built-in predictors. They reach the pipeline through the same descriptors as plug-ins do.

extern const brace_stage_descriptor predict_none;
extern const brace_stage_descriptor predict_constant_rate;
extern const brace_stage_descriptor predict_constant_acceleration;
extern const brace_stage_descriptor predict_kalman;

}  // namespace brace::stages
