#include "stages/control/control.hpp"

namespace brace::stages {

namespace {

char object;  // the stage has no state: every instance is this one

void* create(const double*, uint32_t) {
  return &object;
}
void destroy(void*) {}

brace_result update(void*, const brace_control_input*, double* quality) {
  *quality = 1.0;
  return BRACE_OK;
}

constexpr brace_control_functions functions{sizeof(brace_control_functions), update};

}  // namespace

const brace_stage_descriptor control_fixed{.struct_size = sizeof(brace_stage_descriptor),
                                           .kind = BRACE_KIND_CONTROL,
                                           .name = "fixed",
                                           .version = "1.0.0",
                                           .help = "no load control: every frame has the full ray count",
                                           .params = nullptr,
                                           .param_count = 0,
                                           .create = create,
                                           .destroy = destroy,
                                           .functions = &functions,
                                           .activate = nullptr,
                                           .deactivate = nullptr,
                                           .last_error = nullptr};

}  // namespace brace::stages
