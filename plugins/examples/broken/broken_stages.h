#ifndef BROKEN_STAGES_H
#define BROKEN_STAGES_H

#include "brace_stage.h"

struct VkBufferCopy;

typedef void (*broken_fill)(struct VkCommandBuffer_T*, struct VkBuffer_T*, uint64_t offset, uint64_t size,
                            uint32_t word);
typedef void (*broken_copy)(struct VkCommandBuffer_T*, struct VkBuffer_T*, struct VkBuffer_T*, uint32_t count,
                            const uint64_t* regions); /* VkBufferCopy: from, to, size */

typedef struct broken {
  int defect;
  double gain;
  int activations;
  const char* error;
  broken_fill fill; /* vkCmdFillBuffer */
  broken_copy copy; /* vkCmdCopyBuffer */
} broken;

enum { BROKEN_PARAM_COUNT = 2 };
extern const brace_param broken_params[BROKEN_PARAM_COUNT];

brace_result broken_misbehave(broken* self);
uint32_t broken_noise_word(const broken* self);
int broken_has(const broken* self, const char* defect);
brace_result broken_find_vulkan(broken* self, const brace_vulkan* vulkan);

extern const brace_rays_functions broken_rays_functions;
extern const brace_stereo_functions broken_stereo_functions;
extern const brace_warp_functions broken_warp_functions;

#endif
