// control/pi and control/quantile: the controllers of load_control.hpp as stages.
#include <cstdio>
#include <new>

#include "stages/control/control.hpp"
#include "stages/control/load_control.hpp"
#include "stages/float_parameter.hpp"

namespace brace::stages {

namespace {

FrameLoad load_of(const brace_control_input& input) {
  const double cost = static_cast<double>(input.frame_cost_ns) /
                      static_cast<double>(input.budget_ns > 0 ? input.budget_ns : 1);
  return {cost, input.missed > 0 || cost > 1.0};
}

constexpr PiControl::Settings pi_fallback;
constexpr brace_param pi_params[] = {
    float_parameter("target", "", "share of the time per display period to use", 0.1, 1, pi_fallback.target),
    float_parameter("gain_p", "", "of the change of ln(cost / target)", 0, 2, pi_fallback.p),
    float_parameter("gain_i", "", "of ln(cost / target)", 0.001, 2, pi_fallback.i),
    float_parameter("cost_exponent", "", "cost goes as quality to this power: for the check of stability",
                    0.1, 4, 1),
    float_parameter("quality_min", "", "quality never falls below this", 0.001, 1, pi_fallback.quality_min)};

struct Pi {
  PiControl::Settings settings;
  double cost_exponent = 1;
  PiControl control{settings};
  char error[160] = "";
};

void* create_pi(const double* values, uint32_t) {
  const PiControl::Settings settings{values[0], values[1], values[2], values[4]};
  return new (std::nothrow) Pi{settings, values[3], PiControl(settings), ""};
}

void destroy_pi(void* self) {
  delete static_cast<Pi*>(self);
}

brace_result activate_pi(void* object, const brace_activation*) {
  auto* self = static_cast<Pi*>(object);
  self->control = PiControl(self->settings);
  return BRACE_OK;
}

brace_result update_pi(void* object, const brace_control_input* input, double* quality) {
  auto* self = static_cast<Pi*>(object);
  const PiControl::Settings& s = self->settings;
  if (!pi_control_is_stable(self->cost_exponent * s.p, self->cost_exponent * s.i, input->delay_frames)) {
    std::snprintf(self->error, sizeof self->error,
                  "gain_p = %g and gain_i = %g do not settle with cost_exponent = %g at a delay of %u frames",
                  s.p, s.i, self->cost_exponent, input->delay_frames);
    return BRACE_UNSUPPORTED;
  }
  *quality = self->control.update(load_of(*input));
  return BRACE_OK;
}

const char* error_of_pi(void* self) {
  return static_cast<Pi*>(self)->error;
}

constexpr brace_control_functions pi_functions{sizeof(brace_control_functions), update_pi};

constexpr QuantileControl::Settings quantile_fallback;
constexpr brace_param quantile_params[] = {
    float_parameter("missed_share", "", "share of frames over time to settle at", 0.0001, 0.5,
                    quantile_fallback.missed_share),
    float_parameter("step", "", "taken off ln(quality) at a miss", 0.001, 2, quantile_fallback.step),
    float_parameter("quality_min", "", "quality never falls below this", 0.001, 1,
                    quantile_fallback.quality_min),
    {.struct_size = sizeof(brace_param),
     .name = "proportional_cut",
     .type = BRACE_PARAM_BOOL,
     .unit = "",
     .help = "a miss takes ln(cost / budget) where that is more than step",
     .minimum = 0,
     .maximum = 1,
     .default_value = 1,
     .choices = nullptr}};

struct Quantile {
  QuantileControl::Settings settings;
  QuantileControl control{settings};
};

void* create_quantile(const double* values, uint32_t) {
  const QuantileControl::Settings settings{values[0], values[1], values[2], values[3] != 0.0};
  return new (std::nothrow) Quantile{settings, QuantileControl(settings)};
}

void destroy_quantile(void* self) {
  delete static_cast<Quantile*>(self);
}

brace_result activate_quantile(void* object, const brace_activation*) {
  auto* self = static_cast<Quantile*>(object);
  self->control = QuantileControl(self->settings);
  return BRACE_OK;
}

brace_result update_quantile(void* object, const brace_control_input* input, double* quality) {
  *quality = static_cast<Quantile*>(object)->control.update(load_of(*input));
  return BRACE_OK;
}

constexpr brace_control_functions quantile_functions{sizeof(brace_control_functions), update_quantile};

}  // namespace

const brace_stage_descriptor control_pi{
    .struct_size = sizeof(brace_stage_descriptor),
    .kind = BRACE_KIND_CONTROL,
    .name = "pi",
    .version = "1.0.0",
    .help = "proportional-integral control of the frame's cost, in logarithms; gains checked for stability",
    .params = pi_params,
    .param_count = 5,
    .create = create_pi,
    .destroy = destroy_pi,
    .functions = &pi_functions,
    .activate = activate_pi,
    .deactivate = nullptr,
    .last_error = error_of_pi};

const brace_stage_descriptor control_quantile{
    .struct_size = sizeof(brace_stage_descriptor),
    .kind = BRACE_KIND_CONTROL,
    .name = "quantile",
    .version = "1.0.0",
    .help = "holds the share of frames over time, whatever the costs",
    .params = quantile_params,
    .param_count = 4,
    .create = create_quantile,
    .destroy = destroy_quantile,
    .functions = &quantile_functions,
    .activate = activate_quantile,
    .deactivate = nullptr,
    .last_error = nullptr};

}  // namespace brace::stages
