#include <new>
#include <span>

#include "hmd_sim/predictors.hpp"
#include "stages/float_parameter.hpp"
#include "stages/predict/predict.hpp"

namespace brace::stages {

namespace {

constexpr brace_param params[] = {
    float_parameter("angular_limit_rad_s2", "rad/s^2",
                    "a larger angular acceleration is taken for noise or a reversal: constant rate instead",
                    0, 1e6, 120),
    float_parameter("linear_limit_m_s2", "m/s^2", "the same for linear acceleration", 0, 1e6, 60),
    float_parameter("horizon_ms", "ms", "the acceleration is held no longer than this", 0, 1000, 60)};

void* create(const double* values, uint32_t) {
  return new (std::nothrow) sim::AccelerationLimits{
      .angular_rad_s2 = values[0], .linear_m_s2 = values[1], .horizon = from_s(values[2] * 1e-3)};
}

void destroy(void* self) {
  delete static_cast<sim::AccelerationLimits*>(self);
}

brace_result predict(void* self, const brace_tracker_sample* history, uint32_t count, int64_t target_ns,
                     brace_pose* world_from_head) {
  *world_from_head = sim::to_abi(sim::predict_constant_acceleration(
      std::span(history, count), sim_time(target_ns), *static_cast<sim::AccelerationLimits*>(self)));
  return BRACE_OK;
}

constexpr brace_predict_functions functions{sizeof(brace_predict_functions), predict};

}  // namespace

const brace_stage_descriptor predict_constant_acceleration{
    .struct_size = sizeof(brace_stage_descriptor),
    .kind = BRACE_KIND_PREDICT,
    .name = "constant_acceleration",
    .version = "1.0.0",
    .help = "as constant_rate, and the rates go on changing as they did; clamped, with fallback",
    .params = params,
    .param_count = 3,
    .create = create,
    .destroy = destroy,
    .functions = &functions,
    .activate = nullptr,
    .deactivate = nullptr,
    .last_error = nullptr};

}  // namespace brace::stages
