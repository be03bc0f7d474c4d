#include <span>

#include "hmd_sim/predictors.hpp"
#include "stages/predict/predict.hpp"

namespace brace::stages {

namespace {

char object;  // the stage has no state: every instance is this one

void* create(const double*, uint32_t) {
  return &object;
}
void destroy(void*) {}

brace_result predict(void*, const brace_tracker_sample* history, uint32_t count, int64_t target_ns,
                     brace_pose* world_from_head) {
  *world_from_head = sim::to_abi(sim::predict_none(std::span(history, count), sim_time(target_ns)));
  return BRACE_OK;
}

constexpr brace_predict_functions functions{sizeof(brace_predict_functions), predict};

}  // namespace

const brace_stage_descriptor predict_none{.struct_size = sizeof(brace_stage_descriptor),
                                          .kind = BRACE_KIND_PREDICT,
                                          .name = "none",
                                          .version = "1.0.0",
                                          .help = "no prediction: the newest tracker reading as it is",
                                          .params = nullptr,
                                          .param_count = 0,
                                          .create = create,
                                          .destroy = destroy,
                                          .functions = &functions,
                                          .activate = nullptr,
                                          .deactivate = nullptr,
                                          .last_error = nullptr};

}  // namespace brace::stages
