/* predict/@NAME@: the head goes on at the rates of its newest reading, for a while. */
#include <brace/brace_stage.h>
#include <math.h>
#include <stdlib.h>

typedef struct stage {
  double horizon_s_max;
} stage;

enum { P_HORIZON, P_COUNT };

static const brace_param params[P_COUNT] = {
    {sizeof(brace_param), "horizon_ms", BRACE_PARAM_FLOAT, "ms", "The rates are held no longer than this",
     0.0, 1000.0, 50.0, NULL},
};

static void* create(const double* values, uint32_t count) {
  if (count != P_COUNT) return NULL;
  stage* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->horizon_s_max = 1e-3 * values[P_HORIZON];
  return self;
}

static void destroy(void* self) {
  free(self);
}

/* world_from_head = q * turn, where `turn` is the rotation by the head-frame rate over dt. */
static void turn_by(const double q[4], const double rate_rad_s[3], double dt_s, double out[4]) {
  const double speed =
      sqrt(rate_rad_s[0] * rate_rad_s[0] + rate_rad_s[1] * rate_rad_s[1] + rate_rad_s[2] * rate_rad_s[2]);
  const double half = 0.5 * speed * dt_s;
  const double scale = speed > 1e-12 ? sin(half) / speed : 0.5 * dt_s;
  const double r[4] = {scale * rate_rad_s[0], scale * rate_rad_s[1], scale * rate_rad_s[2], cos(half)};
  out[0] = q[3] * r[0] + q[0] * r[3] + q[1] * r[2] - q[2] * r[1];
  out[1] = q[3] * r[1] - q[0] * r[2] + q[1] * r[3] + q[2] * r[0];
  out[2] = q[3] * r[2] + q[0] * r[1] - q[1] * r[0] + q[2] * r[3];
  out[3] = q[3] * r[3] - q[0] * r[0] - q[1] * r[1] - q[2] * r[2];
  const double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3]);
  for (int i = 0; i < 4; ++i)
    out[i] /= length;
}

/* `target_ns` may lie before the newest reading; then the rates run backwards. */
static brace_result predict(void* object, const brace_tracker_sample* history, uint32_t count,
                            int64_t target_ns, brace_pose* world_from_head) {
  const stage* self = object;
  const brace_tracker_sample* newest = &history[count - 1];
  double dt_s = 1e-9 * (double)(target_ns - newest->time_ns);
  dt_s = fmax(-self->horizon_s_max, fmin(dt_s, self->horizon_s_max));
  turn_by(newest->world_from_head.orientation_xyzw, newest->angular_velocity_rad_s, dt_s,
          world_from_head->orientation_xyzw);
  for (int i = 0; i < 3; ++i) {
    world_from_head->position_m[i] =
        newest->world_from_head.position_m[i] + dt_s * newest->linear_velocity_m_s[i];
  }
  return BRACE_OK;
}

static const brace_predict_functions functions = {sizeof functions, predict};

static const brace_stage_descriptor descriptor = {sizeof descriptor,
                                                  BRACE_KIND_PREDICT,
                                                  "@NAME@",
                                                  "0.1.0",
                                                  "The head goes on at the rates of its newest reading",
                                                  params,
                                                  P_COUNT,
                                                  create,
                                                  destroy,
                                                  &functions,
                                                  NULL, /* activate: nothing to do */
                                                  NULL,
                                                  NULL};

static const brace_stage_descriptor* const stages[] = {&descriptor};

BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "@NAME@", "0.1.0", stages, 1);
}
