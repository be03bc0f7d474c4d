#pragma once

#include "plugins/abi/brace_stage.h"

namespace brace::stages {

extern const brace_stage_descriptor control_fixed;
extern const brace_stage_descriptor control_mab_dynamic;
extern const brace_stage_descriptor control_pi;
extern const brace_stage_descriptor control_quantile;

}  // namespace brace::stages
