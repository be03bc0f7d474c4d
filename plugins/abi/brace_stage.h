/* The public C interface of Brace's stages. Plain C11, also valid C++20; depends on nothing.
 *
 * Rules that hold everywhere here:
 *  - Every struct starts with struct_size (bytes, set by whoever fills it) and only ever grows at its end.
 *  - No function throws, longjmps or aborts across this interface; failure is a return value.
 *  - Unless a function says otherwise it is called on the host's frame thread, never concurrently for one
 *    stage object, and the host keeps ownership of every pointer it passes (valid for that call only).
 *  - Units are SI and stand in the names; times are int64 nanoseconds on the simulated clock; frames follow
 *    OpenXR (right-handed, +X right, +Y up, -Z forward). Quaternions are unit, ordered x, y, z, w.
 */
#ifndef BRACE_STAGE_H
#define BRACE_STAGE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BRACE_ABI_VERSION_MAJOR 1
#define BRACE_ABI_VERSION_MINOR 0

typedef enum brace_result {
  BRACE_OK = 0,
  BRACE_ERROR = 1,            /* the stage failed; see last_error */
  BRACE_UNSUPPORTED = 2,      /* the stage cannot serve this configuration */
  BRACE_INVALID_ARGUMENT = 3  /* the host broke the contract */
} brace_result;

typedef struct brace_pose {
  double orientation_xyzw[4]; /* unit quaternion: rotates head-frame vectors into the world */
  double position_m[3];
} brace_pose;

/* One tracker reading as a predictor sees it. Velocities are finite differences of the tracker's own
 * readings: angular in the head frame, linear in the world frame. */
typedef struct brace_tracker_sample {
  int64_t time_ns;
  brace_pose world_from_head;
  double angular_velocity_rad_s[3];
  double linear_velocity_m_s[3];
} brace_tracker_sample;

/* A parameter of a stage: shown by `brace list stages`, checked in sessions before the stage sees it. */
typedef enum brace_param_type {
  BRACE_PARAM_BOOL = 0,
  BRACE_PARAM_INT = 1,
  BRACE_PARAM_FLOAT = 2,
  BRACE_PARAM_CHOICE = 3 /* the value is the index into choices */
} brace_param_type;

typedef struct brace_param {
  uint32_t struct_size;
  const char* name; /* snake_case, unit last: bias_factor, reserve_ms */
  brace_param_type type;
  const char* unit; /* "" if none */
  const char* help; /* one line */
  double minimum, maximum, default_value;
  const char* const* choices; /* null-terminated; null unless CHOICE */
} brace_param;

typedef enum brace_kind {
  BRACE_KIND_RAYS = 1,
  BRACE_KIND_CAST = 2,
  BRACE_KIND_SKIP = 3,
  BRACE_KIND_STEREO = 4,
  BRACE_KIND_SCHEDULE = 5,
  BRACE_KIND_WARP = 6,
  BRACE_KIND_CONTROL = 7,
  BRACE_KIND_PREDICT = 8,
  BRACE_KIND_COST = 9
} brace_kind;

/* predict: head pose at a future time from what the tracker has reported so far. */
typedef struct brace_predict_functions {
  uint32_t struct_size;
  /* history: `count` >= 1 samples, oldest first, times strictly increasing. target_ns may lie before the
   * newest sample. Must not allocate. */
  brace_result (*predict)(void* self, const brace_tracker_sample* history, uint32_t count, int64_t target_ns,
                          brace_pose* world_from_head);
} brace_predict_functions;

/* control: follows the load. Called once per finished eye frame. */
typedef struct brace_control_input {
  uint32_t struct_size;
  uint64_t frame;
  int64_t frame_cost_ns;  /* device time of the frame's ray casting */
  int64_t budget_ns;      /* device time available per display period */
  uint32_t missed;        /* vsyncs missed since the last call */
  uint32_t delay_frames;  /* frames between a decision and its effect */
} brace_control_input;

typedef struct brace_control_functions {
  uint32_t struct_size;
  /* quality: 0 < quality <= 1, the fraction of the full ray count asked of the next frame. Must not allocate. */
  brace_result (*update)(void* self, const brace_control_input* input, double* quality);
} brace_control_functions;

/* cost: the duration of a job on the simulated GPU from its counted work. */
typedef struct brace_work_counts {
  uint64_t rays, samples, skip_steps, shading_fetches, texels, bytes;
} brace_work_counts;

typedef struct brace_cost_functions {
  uint32_t struct_size;
  /* job: "cast", "warp" or "update". Must not allocate. */
  brace_result (*cost)(void* self, const char* job, const brace_work_counts* work, int64_t* duration_ns);
} brace_cost_functions;

/* A stage: what it is and how to make one. Static data; lives as long as the library is loaded. */
typedef struct brace_stage_descriptor {
  uint32_t struct_size;
  brace_kind kind;
  const char* name;    /* without the family: "kalman" */
  const char* version; /* "1.2.0" */
  const char* help;    /* one line */
  const brace_param* params;
  uint32_t param_count;
  /* values: param_count numbers in the order of params. Returns null on failure. The host destroys it. */
  void* (*create)(const double* values, uint32_t count);
  void (*destroy)(void* self); /* takes back ownership; never fails */
  const void* functions;       /* the kind's table: brace_predict_functions for BRACE_KIND_PREDICT, … */
} brace_stage_descriptor;

#ifdef __cplusplus
}
#endif

#endif
