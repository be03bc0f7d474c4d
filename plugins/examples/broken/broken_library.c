/* One source for libraries that are wrong as libraries; BROKEN chooses how. */
#include <stddef.h>

#include "brace_stage.h"

static void* create(const double* values, uint32_t count) {
  static int object;
  (void)values;
  (void)count;
  return &object;
}
static void destroy(void* self) {
  (void)self;
}
static brace_result update(void* self, const brace_control_input* input, double* quality) {
  (void)self;
  (void)input;
  *quality = 1.0;
  return BRACE_OK;
}
#if defined(BROKEN_ACTIVATE_ALONE)
static brace_result activate(void* self, const brace_activation* activation) {
  (void)self;
  (void)activation;
  return BRACE_OK;
}
#endif

static const brace_param params[] = {
#if defined(BROKEN_DEFAULT)
    {sizeof(brace_param), "gain", BRACE_PARAM_FLOAT, "", "out of its own range", 0.0, 1.0, 2.0, NULL},
#elif defined(BROKEN_CHOICES)
    {sizeof(brace_param), "gain", BRACE_PARAM_CHOICE, "", "no choices", 0.0, 1.0, 0.0, NULL},
#elif defined(BROKEN_PARAM_NAME)
    {sizeof(brace_param), "Bad Name", BRACE_PARAM_FLOAT, "", "a name with a blank", 0.0, 1.0, 0.0, NULL},
#else
    {sizeof(brace_param), "gain", BRACE_PARAM_FLOAT, "", "nothing", 0.0, 1.0, 0.5, NULL},
#endif
#if defined(BROKEN_PARAM_TWICE)
    {sizeof(brace_param), "gain", BRACE_PARAM_FLOAT, "", "again", 0.0, 1.0, 0.5, NULL},
#endif
};

static const brace_control_functions functions = {
#if defined(BROKEN_TABLE_SIZE)
    4,
#else
    sizeof functions,
#endif
#if defined(BROKEN_TABLE)
    0 ? update : NULL
#else
    update
#endif
};

static const brace_stage_descriptor descriptor = {
#if defined(BROKEN_SIZE)
    8,
#else
    sizeof descriptor,
#endif
#if defined(BROKEN_KIND)
    99,
#elif defined(BROKEN_SCHEDULE)
    BRACE_KIND_SCHEDULE,
#else
    BRACE_KIND_CONTROL,
#endif
#if defined(BROKEN_NAME)
    NULL,
#else
    "library",
#endif
    "1.0.0",
    "A stage of a library for tests",
    params,
    sizeof params / sizeof params[0],
#if defined(BROKEN_CREATE)
    0 ? create : NULL,
#else
    create,
#endif
    destroy,
    &functions,
#if defined(BROKEN_ACTIVATE_ALONE)
    activate,
#else
    NULL,
#endif
    NULL,
    NULL};

static const brace_stage_descriptor* const stages[] = {&descriptor};

#if defined(BROKEN_NO_ENTRY)
BRACE_EXPORT brace_result another_entry(const brace_host* host, brace_library* library);
BRACE_EXPORT brace_result another_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "library", "1.0.0", stages, 1);
}
#else
BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
#if defined(BROKEN_VERSION)
  library->abi_version_min = BRACE_ABI_VERSION_MAKE(7, 0);
  library->abi_version_max = BRACE_ABI_VERSION_MAKE(7, 2);
  library->name = "library";
  (void)host;
  (void)stages;
  return BRACE_UNSUPPORTED;
#elif defined(BROKEN_ENTRY_FAILS)
  (void)brace_fill_library(host, library, "library", "1.0.0", stages, 1);
  return BRACE_ERROR;
#elif defined(BROKEN_NO_STAGES)
  (void)stages;
  return brace_fill_library(host, library, "library", "1.0.0", NULL, 0);
#elif defined(BROKEN_NEGOTIATION)
  const brace_result result = brace_fill_library(host, library, "library", "1.0.0", stages, 1);
  library->abi_version = BRACE_ABI_VERSION_MAKE(9, 9);
  return result;
#else
  return brace_fill_library(host, library, "library", "1.0.0", stages, 1);
#endif
}
#endif
