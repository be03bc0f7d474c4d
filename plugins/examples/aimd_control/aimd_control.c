/* control/aimd: additive increase, multiplicative decrease of the ray count, as congestion control does it. A
 * frame over its target cuts the quality to what would have met it (never by more than half at once), a frame
 * under it adds a fixed step. A missed vsync always cuts. */
#include <stdlib.h>

#include "brace_stage.h"

typedef struct aimd {
  double target, increase, floor;
  double quality;
  uint32_t wait_frames; /* until the last cut can have been seen: no second cut for the same overload */
} aimd;

enum { P_TARGET, P_INCREASE, P_FLOOR, P_COUNT };

static const brace_param params[P_COUNT] = {
    {sizeof(brace_param), "target", BRACE_PARAM_FLOAT, "", "Share of the time per display period to use", 0.1,
     1.0, 0.85, NULL},
    {sizeof(brace_param), "increase", BRACE_PARAM_FLOAT, "", "Added to the quality after a frame on time",
     0.0001, 0.5, 0.01, NULL},
    {sizeof(brace_param), "floor", BRACE_PARAM_FLOAT, "", "Quality never falls below this", 0.01, 1.0, 0.05,
     NULL},
};

static void* aimd_create(const double* values, uint32_t count) {
  if (count != P_COUNT) return NULL;
  aimd* self = malloc(sizeof *self);
  if (self == NULL) return NULL;
  self->target = values[P_TARGET];
  self->increase = values[P_INCREASE];
  self->floor = values[P_FLOOR];
  self->quality = 1.0;
  self->wait_frames = 0;
  return self;
}

static void aimd_destroy(void* self) {
  free(self);
}

static brace_result aimd_activate(void* object, const brace_activation* activation) {
  aimd* self = object;
  (void)activation;
  self->quality = 1.0;
  self->wait_frames = 0;
  return BRACE_OK;
}

static void aimd_deactivate(void* self) {
  (void)self;
}

static brace_result aimd_update(void* object, const brace_control_input* input, double* quality) {
  aimd* self = object;
  const double aim_ns = self->target * (double)input->budget_ns;
  const double cost_ns = (double)input->frame_cost_ns;
  const int is_late = input->missed > 0 || cost_ns > aim_ns;
  if (self->wait_frames > 0) {
    --self->wait_frames;
  } else if (is_late) {
    double factor = cost_ns > aim_ns ? aim_ns / cost_ns : 0.9;
    if (factor < 0.5) factor = 0.5;
    self->quality *= factor;
    self->wait_frames = input->delay_frames;
  } else {
    self->quality += self->increase;
  }
  if (self->quality > 1.0) self->quality = 1.0;
  if (self->quality < self->floor) self->quality = self->floor;
  *quality = self->quality;
  return BRACE_OK;
}

static const brace_control_functions functions = {sizeof functions, aimd_update};

static const brace_stage_descriptor descriptor = {
    sizeof descriptor,
    BRACE_KIND_CONTROL,
    "aimd",
    "1.0.0",
    "Additive increase, multiplicative decrease of the ray count",
    params,
    P_COUNT,
    aimd_create,
    aimd_destroy,
    &functions,
    aimd_activate,
    aimd_deactivate,
    NULL};

static const brace_stage_descriptor* const stages[] = {&descriptor};

BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "aimd_control", "1.0.0", stages, 1);
}
