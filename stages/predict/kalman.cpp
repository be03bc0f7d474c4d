#include <new>
#include <span>

#include "hmd_sim/kalman_predictor.hpp"
#include "hmd_sim/tracker.hpp"
#include "stages/float_parameter.hpp"
#include "stages/predict/predict.hpp"

namespace brace::stages {

namespace {

constexpr sim::KalmanModel fallback;
constexpr brace_param params[] = {
    float_parameter("orientation_noise_rad", "rad", "standard deviation of a reading, per axis", 0, 1,
                    fallback.orientation_noise_rad),
    float_parameter("position_noise_m", "m", "standard deviation of a reading, per axis", 0, 1,
                    fallback.position_noise_m),
    float_parameter("angular_acceleration_rad_s2", "rad/s^2", "standard deviation of the head's, per axis", 0,
                    1e6, fallback.angular_acceleration_rad_s2),
    float_parameter("linear_acceleration_m_s2", "m/s^2", "standard deviation of the head's, per axis", 0, 1e6,
                    fallback.linear_acceleration_m_s2),
    float_parameter("manoeuvre_time_ms", "ms", "after which an acceleration has fallen to 1/e", 1, 1e6,
                    fallback.manoeuvre_time_s * 1e3)};

void* create(const double* values, uint32_t) {
  sim::KalmanModel model;
  model.orientation_noise_rad = values[0];
  model.position_noise_m = values[1];
  model.angular_acceleration_rad_s2 = values[2];
  model.linear_acceleration_m_s2 = values[3];
  model.manoeuvre_time_s = values[4] * 1e-3;
  return new (std::nothrow) sim::KalmanPredictor(model);
}

void destroy(void* self) {
  delete static_cast<sim::KalmanPredictor*>(self);
}

brace_result predict(void* self, const brace_tracker_sample* history, uint32_t count, int64_t target_ns,
                     brace_pose* world_from_head) {
  *world_from_head = sim::to_abi(
      static_cast<sim::KalmanPredictor*>(self)->predict(std::span(history, count), sim_time(target_ns)));
  return BRACE_OK;
}

constexpr brace_predict_functions functions{sizeof(brace_predict_functions), predict};

}  // namespace

const brace_stage_descriptor predict_kalman{
    .struct_size = sizeof(brace_stage_descriptor),
    .kind = BRACE_KIND_PREDICT,
    .name = "kalman",
    .version = "1.0.0",
    .help = "error-state Kalman filter: rates and accelerations from readings with noise",
    .params = params,
    .param_count = 5,
    .create = create,
    .destroy = destroy,
    .functions = &functions,
    .activate = nullptr,
    .deactivate = nullptr,
    .last_error = nullptr};

}  // namespace brace::stages
