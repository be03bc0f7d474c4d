/* control/@NAME@: asks for as many rays as fit into a share of the time per display period. */
#include <brace/brace_stage.h>
#include <stdlib.h>

typedef struct stage {
  double target, smoothing; /* the parameters */
  double quality;
} stage;

enum { P_TARGET, P_SMOOTHING, P_COUNT };

static const brace_param params[P_COUNT] = {
    {sizeof(brace_param), "target", BRACE_PARAM_FLOAT, "", "Share of the time per display period to use", 0.1,
     1.0, 0.8, NULL},
    {sizeof(brace_param), "smoothing", BRACE_PARAM_FLOAT, "", "How much of the last quality is kept", 0.0,
     0.99, 0.5, NULL},
};

static void* create(const double* values, uint32_t count) {
  if (count != P_COUNT) return NULL;
  stage* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->target = values[P_TARGET];
  self->smoothing = values[P_SMOOTHING];
  return self;
}

static void destroy(void* self) {
  free(self);
}

static brace_result activate(void* object, const brace_activation* activation) {
  (void)activation;
  ((stage*)object)->quality = 1.0;
  return BRACE_OK;
}

/* activate and deactivate come together; this one has nothing to give back. */
static void deactivate(void* object) {
  (void)object;
}

/* Once per finished eye frame; the quality is the fraction of all rays that the next frame gets. */
static brace_result update(void* object, const brace_control_input* input, double* quality) {
  stage* self = object;
  if (input->frame_cost_ns > 0) {
    const double fits = self->target * (double)input->budget_ns / (double)input->frame_cost_ns;
    const double wanted = self->quality * fits;
    self->quality = self->smoothing * self->quality + (1.0 - self->smoothing) * wanted;
  }
  if (!(self->quality >= 0.05)) self->quality = 0.05;
  if (self->quality > 1.0) self->quality = 1.0;
  *quality = self->quality;
  return BRACE_OK;
}

static const brace_control_functions functions = {sizeof functions, update};

static const brace_stage_descriptor descriptor = {sizeof descriptor,
                                                  BRACE_KIND_CONTROL,
                                                  "@NAME@",
                                                  "0.1.0",
                                                  "As many rays as fit into a share of the time",
                                                  params,
                                                  P_COUNT,
                                                  create,
                                                  destroy,
                                                  &functions,
                                                  activate,
                                                  deactivate,
                                                  NULL};

static const brace_stage_descriptor* const stages[] = {&descriptor};

BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "@NAME@", "0.1.0", stages, 1);
}
