#include <algorithm>
#include <new>
#include <span>

#include "hmd_sim/predictors.hpp"
#include "stages/float_parameter.hpp"
#include "stages/predict/predict.hpp"

namespace brace::stages {

namespace {

struct ConstantRate {
  int64_t horizon_ns;
};

constexpr brace_param params[] = {float_parameter(
    "horizon_ms", "ms",
    "the rate is held no longer than this beyond the newest reading (a tracker that fell silent)", 0, 1000,
    100)};

void* create(const double* values, uint32_t) {
  return new (std::nothrow) ConstantRate{to_ns(from_s(values[0] * 1e-3))};
}

void destroy(void* self) {
  delete static_cast<ConstantRate*>(self);
}

brace_result predict(void* self, const brace_tracker_sample* history, uint32_t count, int64_t target_ns,
                     brace_pose* world_from_head) {
  const int64_t limit_ns = history[count - 1].time_ns + static_cast<ConstantRate*>(self)->horizon_ns;
  const SimTime target = sim_time(std::min(target_ns, limit_ns));
  *world_from_head = sim::to_abi(sim::predict_constant_rate(std::span(history, count), target));
  return BRACE_OK;
}

constexpr brace_predict_functions functions{sizeof(brace_predict_functions), predict};

}  // namespace

const brace_stage_descriptor predict_constant_rate{
    .struct_size = sizeof(brace_stage_descriptor),
    .kind = BRACE_KIND_PREDICT,
    .name = "constant_rate",
    .version = "1.0.0",
    .help = "the head goes on turning and moving as between the last tracker readings",
    .params = params,
    .param_count = 1,
    .create = create,
    .destroy = destroy,
    .functions = &functions,
    .activate = nullptr,
    .deactivate = nullptr,
    .last_error = nullptr};

}  // namespace brace::stages
