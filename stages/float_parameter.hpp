#pragma once

#include "plugins/abi/brace_stage.h"

namespace brace::stages {

/// A number that a built-in stage takes; `unit` is "" if it has none.
constexpr brace_param float_parameter(const char* name, const char* unit, const char* help, double minimum,
                                      double maximum, double default_value) {
  return {.struct_size = sizeof(brace_param),
          .name = name,
          .type = BRACE_PARAM_FLOAT,
          .unit = unit,
          .help = help,
          .minimum = minimum,
          .maximum = maximum,
          .default_value = default_value,
          .choices = nullptr};
}

}  // namespace brace::stages
