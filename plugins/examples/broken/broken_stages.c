/* A library whose stages break one rule each, chosen by the parameter `defect`; with `none` they keep all of
 * them. For the tests of the watchdog and of `brace check-stage`: every clause must find its defect. */
#include "broken_stages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

const brace_param broken_params[BROKEN_PARAM_COUNT] = {
    {sizeof(brace_param), "defect", BRACE_PARAM_INT, "", "The rule to break: see broken_stages.h",
     BROKEN_NONE, BROKEN_NOTHING_EITHER, BROKEN_NONE, NULL},
    {sizeof(brace_param), "gain", BRACE_PARAM_FLOAT, "", "Brightness, for checks of extremes", 0.0, 1.0, 0.5,
     NULL},
};

/* What BROKEN_LEAKS takes and does not give back while the library is loaded. */
typedef struct leaked {
  struct leaked* next;
  char bytes[1000];
} leaked;
static leaked* kept;

__attribute__((destructor)) static void give_back_at_unload(void) {
  while (kept != NULL) {
    leaked* next = kept->next;
    free(kept);
    kept = next;
  }
}

static uint32_t calls;

void* broken_create(const double* values, uint32_t count) {
  if (count != BROKEN_PARAM_COUNT || (int)values[0] == BROKEN_CREATE_FAILS) return NULL;
  broken* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->defect = (int)values[0];
  self->gain = values[1];
  self->error = "";
  return self;
}

void broken_destroy(void* self) {
  free(self);
}

brace_result broken_activate(void* object, const brace_activation* activation) {
  broken* self = object;
  ++self->activations;
  self->width_px = activation->eye_width_px;
  if (self->defect == BROKEN_ACTIVATE_FAILS ||
      (self->defect == BROKEN_SECOND_ACTIVATION_FAILS && self->activations > 1)) {
    self->error = "this stage does not activate";
    return BRACE_UNSUPPORTED;
  }
  if (self->defect == BROKEN_LEAKS) {
    leaked* block = malloc(sizeof *block);
    if (block == NULL) return BRACE_ERROR;
    block->next = kept;
    kept = block;
  }
  return broken_find_vulkan(self, activation->vulkan);
}

void broken_deactivate(void* self) {
  (void)self;
}

const char* broken_last_error(void* object) {
  const broken* self = object;
  return self->error;
}

/* What can go wrong in any call, whatever the kind. */
static brace_result misbehave(broken* self) {
  if (self->defect == BROKEN_RECORD_FAILS) {
    self->error = "this stage fails in every frame";
    return BRACE_ERROR;
  }
  if (self->defect == BROKEN_FAILS_ODD_SIZES && self->width_px % 2 == 1 && self->width_px > 1) {
    self->error = "this stage wants an even width";
    return BRACE_UNSUPPORTED;
  }
  if (self->defect == BROKEN_FAILS_AT_EXTREMES && (self->gain == 0.0 || self->gain == 1.0)) {
    self->error = "this stage fails where a parameter is at its end";
    return BRACE_ERROR;
  }
  if (self->defect == BROKEN_ALLOCATES) {
    void* volatile block = malloc(64);
    free(block);
  }
  if (self->defect == BROKEN_SLOW) {
    const struct timespec wait = {0, 30000000};
    nanosleep(&wait, NULL);
  }
  return BRACE_OK;
}

/* A value that differs from call to call under BROKEN_NOT_DETERMINISTIC and is 0 else. */
static double noise(const broken* self) {
  return self->defect == BROKEN_NOT_DETERMINISTIC ? 0.001 * (double)(++calls % 7u) : 0.0;
}

/* ---- cast ---- */

static void cast_ray(const broken* self, const brace_cast_frame* frame, size_t ray, double change) {
  const float* entry = (const float*)frame->ray_entries.mapped + 4 * ray;
  float* colour = (float*)frame->result_colours.mapped + 4 * ray;
  float* depth_m = (float*)frame->result_depths_m.mapped + ray;
  const int hits = entry[3] > 0.0f || self->defect == BROKEN_PAINTS_MISSES;
  const float opacity = hits ? 0.5f : 0.0f;
  const float level = opacity * (float)(self->gain * 0.9 + change);
  for (int c = 0; c < 3; ++c)
    colour[c] = level;
  colour[3] = opacity;
  *depth_m = hits ? 1.0f : INFINITY;
  if (!hits) return;
  if (self->defect == BROKEN_NOT_A_NUMBER && ray % 5 == 0) colour[1] = NAN;
  if (self->defect == BROKEN_COLOUR_OVER_OPACITY && ray % 5 == 0) colour[0] = 0.75f;
  if (self->defect == BROKEN_OPACITY_OVER_ONE) colour[3] = 1.25f;
  if (self->defect == BROKEN_BAD_DEPTH) *depth_m = -1.0f;
}

static brace_result cast_execute(void* object, const brace_cast_frame* frame) {
  broken* self = object;
  const brace_result result = misbehave(self);
  if (result != BRACE_OK) return result;
  brace_area area = frame->area;
  if (self->defect == BROKEN_WRITES_OUTSIDE_AREA) area.width = frame->rays_across, area.x = 0;
  const double change = noise(self);
  for (uint32_t y = area.y; y < area.y + area.height; ++y) {
    for (uint32_t x = area.x; x < area.x + area.width; ++x) {
      const size_t ray = (size_t)y * frame->rays_across + x;
      if (self->defect == BROKEN_LEAVES_SOME_OUT && x == area.x && y == area.y) continue;
      cast_ray(self, frame, ray, change);
    }
  }
  if (self->defect == BROKEN_CHANGES_INPUT) ((float*)frame->ray_entries.mapped)[3] += 1.0f;
  if (self->defect == BROKEN_WRITES_BEHIND_BUFFER) {
    memset((char*)frame->result_depths_m.mapped + frame->result_depths_m.size_bytes, 0, 4);
  }
  return BRACE_OK;
}

static const brace_cast_functions cast_functions = {sizeof cast_functions, NULL, cast_execute, 0};

/* ---- skip: everything is occupied; BROKEN_IGNORES_OPAQUE says that nothing is ---- */

static uint32_t skip_block_edge(void* object) {
  const broken* self = object;
  return self->defect == BROKEN_OUT_OF_RANGE ? 0u : 4u;
}

static brace_result skip_update(void* object, const brace_skip_frame* frame) {
  broken* self = object;
  const brace_result result = misbehave(self);
  if (result != BRACE_OK) return result;
  uint8_t* distances = frame->distances.mapped;
  const uint8_t distance = self->defect == BROKEN_IGNORES_OPAQUE ? 255 : 0;
  for (uint32_t z = 0; z < frame->blocks[2]; ++z) {
    for (uint32_t y = 0; y < frame->blocks[1]; ++y) {
      uint8_t* row = distances + z * frame->slice_bytes + (uint64_t)y * frame->row_bytes;
      const uint32_t some = self->defect == BROKEN_LEAVES_SOME_OUT && y == 0 && z == 0 ? 1 : 0;
      memset(row, distance, frame->blocks[0] - some);
    }
  }
  /* The block in the corner of the check's volume is empty: 1 is as safe there as 0. */
  if (self->defect == BROKEN_NOT_DETERMINISTIC && ++calls % 2 == 0) distances[0] = 1;
  if (self->defect == BROKEN_WRITES_BEHIND_BUFFER) distances[frame->distances.size_bytes] = 0;
  return BRACE_OK;
}

static const brace_skip_functions skip_functions = {sizeof skip_functions, skip_block_edge, NULL,
                                                    skip_update};

/* ---- predict ---- */

static brace_result predict(void* object, const brace_tracker_sample* history, uint32_t count,
                            int64_t target_ns, brace_pose* pose) {
  broken* self = object;
  const brace_result result = misbehave(self);
  if (result != BRACE_OK) return result;
  if (self->defect == BROKEN_FAILS_ODD_INPUT && target_ns < history[0].time_ns) {
    self->error = "this stage wants a target in the future";
    return BRACE_ERROR;
  }
  *pose = history[count - 1].world_from_head;
  pose->position_m[0] += noise(self);
  if (self->defect == BROKEN_NOT_A_NUMBER) pose->position_m[1] = NAN;
  if (self->defect == BROKEN_OUT_OF_RANGE) pose->orientation_xyzw[3] += 0.5;
  return BRACE_OK;
}

static const brace_predict_functions predict_functions = {sizeof predict_functions, predict};

/* ---- control ---- */

static brace_result control_update(void* object, const brace_control_input* input, double* quality) {
  broken* self = object;
  (void)input;
  const brace_result result = misbehave(self);
  if (result != BRACE_OK) return result;
  *quality = 0.5 + noise(self);
  if (self->defect == BROKEN_NOT_A_NUMBER) *quality = NAN;
  if (self->defect == BROKEN_OUT_OF_RANGE) *quality = 1.5;
  return BRACE_OK;
}

static const brace_control_functions control_functions = {sizeof control_functions, control_update};

/* ---- cost ---- */

static brace_result cost(void* object, const char* job, const brace_work_counts* work, int64_t* duration_ns) {
  broken* self = object;
  (void)job;
  const brace_result result = misbehave(self);
  if (result != BRACE_OK) return result;
  *duration_ns = (int64_t)(1000.0 + 1e6 * noise(self)) + (int64_t)(work->samples / 1000u);
  if (self->defect == BROKEN_OUT_OF_RANGE) *duration_ns = -1;
  return BRACE_OK;
}

static const brace_cost_functions cost_functions = {sizeof cost_functions, cost};

#define BROKEN_STAGE(kind, functions)                                                                 \
  {                                                                                                   \
    sizeof(brace_stage_descriptor), kind, "broken", "1.0.0", "Breaks one rule, chosen by `defect`",   \
        broken_params, BROKEN_PARAM_COUNT, broken_create, broken_destroy, functions, broken_activate, \
        broken_deactivate, broken_last_error                                                          \
  }

static const brace_stage_descriptor descriptors[] = {
    BROKEN_STAGE(BRACE_KIND_CAST, &cast_functions),
    BROKEN_STAGE(BRACE_KIND_SKIP, &skip_functions),
    BROKEN_STAGE(BRACE_KIND_PREDICT, &predict_functions),
    BROKEN_STAGE(BRACE_KIND_CONTROL, &control_functions),
    BROKEN_STAGE(BRACE_KIND_COST, &cost_functions),
    BROKEN_STAGE(BRACE_KIND_RAYS, &broken_rays_functions),
    BROKEN_STAGE(BRACE_KIND_STEREO, &broken_stereo_functions),
    BROKEN_STAGE(BRACE_KIND_WARP, &broken_warp_functions),
};

static const brace_stage_descriptor* const stages[] = {&descriptors[0], &descriptors[1], &descriptors[2],
                                                       &descriptors[3], &descriptors[4], &descriptors[5],
                                                       &descriptors[6], &descriptors[7]};

BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "broken_stages", "1.0.0", stages, 8);
}

brace_result broken_misbehave(broken* self) {
  return misbehave(self);
}
uint32_t broken_noise_word(const broken* self) {
  return self->defect == BROKEN_NOT_DETERMINISTIC ? ++calls % 7u : 0u;
}
