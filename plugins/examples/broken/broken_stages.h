#ifndef BROKEN_STAGES_H
#define BROKEN_STAGES_H

#include "../../abi/brace_stage.h"

/* Values of the parameter `defect`. The ends of its range are harmless, so that a check of the ends finds a
 * stage that keeps every rule. */
enum broken_defect {
  BROKEN_NONE,
  BROKEN_CREATE_FAILS,
  BROKEN_ACTIVATE_FAILS,
  BROKEN_SECOND_ACTIVATION_FAILS,
  BROKEN_RECORD_FAILS,
  BROKEN_LEAKS,
  BROKEN_ALLOCATES,
  BROKEN_NOT_DETERMINISTIC,
  BROKEN_SLOW,
  BROKEN_NOT_A_NUMBER,
  BROKEN_COLOUR_OVER_OPACITY,
  BROKEN_OPACITY_OVER_ONE,
  BROKEN_BAD_DEPTH,
  BROKEN_LEAVES_SOME_OUT,
  BROKEN_WRITES_OUTSIDE_AREA,
  BROKEN_WRITES_BEHIND_BUFFER,
  BROKEN_CHANGES_INPUT,
  BROKEN_PAINTS_MISSES,
  BROKEN_FAILS_ODD_SIZES,
  BROKEN_FAILS_ODD_INPUT,
  BROKEN_FAILS_AT_EXTREMES,
  BROKEN_OUT_OF_RANGE,
  BROKEN_IGNORES_OPAQUE,
  BROKEN_BREAKS_VALIDATION,
  BROKEN_NOTHING_EITHER
};

typedef void (*broken_fill)(struct VkCommandBuffer_T*, struct VkBuffer_T*, uint64_t offset, uint64_t size,
                            uint32_t word);
typedef void (*broken_copy)(struct VkCommandBuffer_T*, struct VkBuffer_T*, struct VkBuffer_T*, uint32_t count,
                            const uint64_t* regions); /* VkBufferCopy: from, to, size */

typedef struct broken {
  int defect;
  double gain;
  int activations;
  uint32_t width_px; /* of the activation */
  const char* error;
  broken_fill fill; /* vkCmdFillBuffer */
  broken_copy copy; /* vkCmdCopyBuffer */
} broken;

enum { BROKEN_PARAM_COUNT = 2 };
extern const brace_param broken_params[BROKEN_PARAM_COUNT];

brace_result broken_misbehave(broken* self);
uint32_t broken_noise_word(const broken* self);
brace_result broken_find_vulkan(broken* self, const brace_vulkan* vulkan);

extern const brace_rays_functions broken_rays_functions;
extern const brace_stereo_functions broken_stereo_functions;
extern const brace_warp_functions broken_warp_functions;

#endif
