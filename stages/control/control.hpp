#pragma once

#include "plugins/abi/brace_stage.h"

namespace brace::stages {

extern const brace_stage_descriptor control_fixed;

}  // namespace brace::stages
