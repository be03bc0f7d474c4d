/* predict/alpha_beta: a filter with constant gains on rotation and position. Each reading first moves the
 * state on at its rates, then corrects the pose by alpha and the rate by beta / dt of what is left over. The
 * prediction goes on at the filtered rates. Gains of 1 give the constant rate of the last two readings. */
#include <math.h>
#include <stdlib.h>

#include "brace_stage.h"

typedef struct filter {
  double alpha, beta, horizon_ns_max;
  int has_state;
  int64_t time_ns;
  double q[4]; /* x, y, z, w */
  double rate_rad_s[3];
  double p_m[3];
  double velocity_m_s[3];
} filter;

enum { P_ALPHA, P_BETA, P_HORIZON, P_COUNT };

static const brace_param params[P_COUNT] = {
    {sizeof(brace_param), "alpha", BRACE_PARAM_FLOAT, "", "Share of a reading's surprise taken into the pose",
     0.01, 1.0, 0.9, NULL},
    {sizeof(brace_param), "beta", BRACE_PARAM_FLOAT, "", "Share of a reading's surprise taken into the rate",
     0.001, 1.0, 0.3, NULL},
    {sizeof(brace_param), "horizon_ms", BRACE_PARAM_FLOAT, "ms", "The rates are held no longer than this",
     0.0, 1000.0, 100.0, NULL},
};

static void multiply(const double a[4], const double b[4], double out[4]) {
  const double x = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  const double y = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
  const double z = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
  const double w = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
  const double length = sqrt(x * x + y * y + z * z + w * w);
  out[0] = x / length, out[1] = y / length, out[2] = z / length, out[3] = w / length;
}

/* Unit quaternion of a rotation vector times a factor. */
static void exponential(const double v[3], double factor, double out[4]) {
  const double angle = factor * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  const double scale = fabs(angle) < 1e-6 ? 0.5 * factor : factor * sin(0.5 * angle) / angle;
  for (int i = 0; i < 3; ++i)
    out[i] = scale * v[i];
  out[3] = cos(0.5 * angle);
}

/* Rotation vector of the shorter way. */
static void logarithm(const double q[4], double out[3]) {
  const double sign = q[3] < 0.0 ? -1.0 : 1.0;
  const double sine = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  const double scale = sine < 1e-9 ? 2.0 : 2.0 * atan2(sine, sign * q[3]) / sine;
  for (int i = 0; i < 3; ++i)
    out[i] = sign * scale * q[i];
}

static void* filter_create(const double* values, uint32_t count) {
  if (count != P_COUNT) return NULL;
  filter* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->alpha = values[P_ALPHA];
  self->beta = values[P_BETA];
  self->horizon_ns_max = values[P_HORIZON] * 1e6;
  return self;
}

static void filter_destroy(void* self) {
  free(self);
}

static brace_result filter_activate(void* object, const brace_activation* activation) {
  filter* self = object;
  (void)activation;
  self->has_state = 0;
  return BRACE_OK;
}

static void filter_deactivate(void* self) {
  (void)self;
}

static void start_at(filter* self, const brace_tracker_sample* sample) {
  self->has_state = 1;
  self->time_ns = sample->time_ns;
  for (int i = 0; i < 4; ++i)
    self->q[i] = sample->world_from_head.orientation_xyzw[i];
  for (int i = 0; i < 3; ++i) {
    self->p_m[i] = sample->world_from_head.position_m[i];
    self->rate_rad_s[i] = sample->angular_velocity_rad_s[i];
    self->velocity_m_s[i] = sample->linear_velocity_m_s[i];
  }
}

static void take(filter* self, const brace_tracker_sample* sample) {
  const double dt_s = (double)(sample->time_ns - self->time_ns) * 1e-9;
  double turn[4], expected[4], inverse[4], left_over[4], surprise[3];
  exponential(self->rate_rad_s, dt_s, turn);
  multiply(self->q, turn, expected);
  for (int i = 0; i < 3; ++i)
    inverse[i] = -expected[i];
  inverse[3] = expected[3];
  multiply(inverse, sample->world_from_head.orientation_xyzw, left_over);
  logarithm(left_over, surprise);
  exponential(surprise, self->alpha, turn);
  multiply(expected, turn, self->q);
  for (int i = 0; i < 3; ++i) {
    self->rate_rad_s[i] += self->beta / dt_s * surprise[i];
    const double moved = self->p_m[i] + dt_s * self->velocity_m_s[i];
    const double off = sample->world_from_head.position_m[i] - moved;
    self->p_m[i] = moved + self->alpha * off;
    self->velocity_m_s[i] += self->beta / dt_s * off;
  }
  self->time_ns = sample->time_ns;
}

static brace_result filter_predict(void* object, const brace_tracker_sample* history, uint32_t count,
                                   int64_t target_ns, brace_pose* world_from_head) {
  filter* self = object;
  for (uint32_t i = 0; i < count; ++i) {
    if (!self->has_state) {
      start_at(self, &history[i]);
    } else if (history[i].time_ns > self->time_ns) {
      take(self, &history[i]);
    }
  }
  double ahead_ns = (double)(target_ns - self->time_ns);
  if (ahead_ns > self->horizon_ns_max) ahead_ns = self->horizon_ns_max;
  double turn[4];
  exponential(self->rate_rad_s, ahead_ns * 1e-9, turn);
  multiply(self->q, turn, world_from_head->orientation_xyzw);
  for (int i = 0; i < 3; ++i) {
    world_from_head->position_m[i] = self->p_m[i] + ahead_ns * 1e-9 * self->velocity_m_s[i];
  }
  return BRACE_OK;
}

static const brace_predict_functions functions = {sizeof functions, filter_predict};

static const brace_stage_descriptor descriptor = {
    sizeof descriptor,
    BRACE_KIND_PREDICT,
    "alpha_beta",
    "1.0.0",
    "Filter with constant gains on pose and rate, then constant rate",
    params,
    P_COUNT,
    filter_create,
    filter_destroy,
    &functions,
    filter_activate,
    filter_deactivate,
    NULL};

static const brace_stage_descriptor* const stages[] = {&descriptor};

BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "alpha_beta", "1.0.0", stages, 1);
}
