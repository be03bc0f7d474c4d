// control/pi, control/quantile and control/mab_dynamic: the controllers of load_control.hpp as stages.
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

constexpr WindowControl::Settings window_fallback;
constexpr brace_param window_params[] = {
    float_parameter("window_frames", "", "frames over which the change of the cost is taken", 2,
                    WindowControl::window_max, static_cast<double>(window_fallback.window_frames)),
    float_parameter("load_min", "", "share of the budget below which more rays are cast", 0.01, 1,
                    window_fallback.load_min),
    float_parameter("load_max", "", "share of the budget above which fewer are", 0.01, 1,
                    window_fallback.load_max),
    float_parameter("step", "", "least change of ln(quality)", 0.0001, 2, window_fallback.step),
    float_parameter("gradient_gain", "", "of the change of ln(cost) over the window", 0, 2,
                    window_fallback.gradient_gain),
    float_parameter("quality_min", "", "quality never falls below this", 0.001, 1,
                    window_fallback.quality_min)};

struct Window {
  WindowControl::Settings settings;
  WindowControl control{settings};
  char error[160] = "";
};

void* create_window(const double* values, uint32_t) {
  const WindowControl::Settings settings{
      static_cast<std::size_t>(values[0]), values[1], values[2], values[3], values[4], values[5]};
  return new (std::nothrow) Window{settings, WindowControl(settings), ""};
}

void destroy_window(void* self) {
  delete static_cast<Window*>(self);
}

brace_result activate_window(void* object, const brace_activation*) {
  auto* self = static_cast<Window*>(object);
  self->control = WindowControl(self->settings);
  return BRACE_OK;
}

brace_result update_window(void* object, const brace_control_input* input, double* quality) {
  auto* self = static_cast<Window*>(object);
  if (!(self->settings.load_min < self->settings.load_max)) {
    std::snprintf(self->error, sizeof self->error, "load_min = %g is not below load_max = %g",
                  self->settings.load_min, self->settings.load_max);
    return BRACE_UNSUPPORTED;
  }
  *quality = self->control.update(load_of(*input));
  return BRACE_OK;
}

const char* error_of_window(void* self) {
  return static_cast<Window*>(self)->error;
}

constexpr brace_control_functions window_functions{sizeof(brace_control_functions), update_window};

}  // namespace

const brace_stage_descriptor control_mab_dynamic{
    .struct_size = sizeof(brace_stage_descriptor),
    .kind = BRACE_KIND_CONTROL,
    .name = "mab_dynamic",
    .version = "1.0.0",
    .help = "two thresholds of the frame's cost; its change over a window decides how far the rays change",
    .params = window_params,
    .param_count = 6,
    .create = create_window,
    .destroy = destroy_window,
    .functions = &window_functions,
    .activate = activate_window,
    .deactivate = nullptr,
    .last_error = error_of_window};

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
