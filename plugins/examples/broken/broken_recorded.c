/* The kinds that record into a command buffer, with no more of Vulkan than fills and copies: blank rays, a
 * right eye that equals the left one, a warp that holds the picture. */
#include <math.h>
#include <stddef.h>

#include "broken_stages.h"

brace_result broken_find_vulkan(broken* self, const brace_vulkan* vulkan) {
  if (vulkan == NULL) return BRACE_OK;
  typedef void (*any)(void);
  typedef any (*get_device_proc)(struct VkDevice_T*, const char*);
  const get_device_proc get =
      (get_device_proc)vulkan->get_instance_proc_addr(vulkan->instance, "vkGetDeviceProcAddr");
  if (get == NULL) return BRACE_ERROR;
  self->fill = (broken_fill)get(vulkan->device, "vkCmdFillBuffer");
  self->copy = (broken_copy)get(vulkan->device, "vkCmdCopyBuffer");
  return self->fill != NULL && self->copy != NULL ? BRACE_OK : BRACE_ERROR;
}

static void fill(const broken* self, struct VkCommandBuffer_T* commands, const brace_buffer_range* range,
                 uint32_t word) {
  uint64_t bytes = range->size_bytes;
  if (self->defect == BROKEN_LEAVES_SOME_OUT) bytes -= 4;
  if (self->defect == BROKEN_WRITES_BEHIND_BUFFER) bytes += 4;
  if (bytes > 0) self->fill(commands, range->buffer, range->offset_bytes, bytes, word);
}

static void copy(const broken* self, struct VkCommandBuffer_T* commands, const brace_buffer_range* from,
                 const brace_buffer_range* to) {
  uint64_t region[3] = {from->offset_bytes, to->offset_bytes, from->size_bytes};
  if (self->defect == BROKEN_LEAVES_SOME_OUT) region[2] -= 4;
  if (self->defect == BROKEN_WRITES_BEHIND_BUFFER) {
    self->fill(commands, to->buffer, to->offset_bytes + to->size_bytes, 4, 0);
  }
  /* Vulkan forbids a copy of nothing; no driver minds it. */
  const uint64_t nothing[3] = {from->offset_bytes, to->offset_bytes, 0};
  if (self->defect == BROKEN_BREAKS_VALIDATION) self->copy(commands, from->buffer, to->buffer, 1, nothing);
  if (region[2] > 0) self->copy(commands, from->buffer, to->buffer, 1, region);
}

static brace_result rays_open(void* object, const brace_cast_frame* frame) {
  broken* self = object;
  const brace_result result = broken_misbehave(self);
  if (result != BRACE_OK) return result;
  /* Entry (0, 0, 0) and length 0: no ray. Direction (1, 1, 1), level 1. */
  fill(self, frame->commands, &frame->ray_entries, (self->defect == BROKEN_NOT_A_NUMBER) ? 0x7fc00000u : 0u);
  fill(self, frame->commands, &frame->ray_directions, 0x3f800000u + broken_noise_word(self));
  return BRACE_OK;
}

static brace_result rays_close(void* object, const brace_cast_frame* frame) {
  broken* self = object;
  const brace_result result = broken_misbehave(self);
  if (result != BRACE_OK) return result;
  fill(self, frame->commands, &frame->eye_image,
       self->defect == BROKEN_COLOUR_OVER_OPACITY ? 0x800000ffu : 0x80000000u + broken_noise_word(self));
  fill(self, frame->commands, &frame->eye_depth_m,
       self->defect == BROKEN_BAD_DEPTH ? 0xbf800000u : 0x3f800000u);
  if (self->defect == BROKEN_CHANGES_INPUT)
    self->fill(frame->commands, frame->result_colours.buffer, frame->result_colours.offset_bytes, 4,
               0x3e000000u);
  return BRACE_OK;
}

const brace_rays_functions broken_rays_functions = {sizeof broken_rays_functions, rays_open, rays_close};

static brace_result stereo_record(void* object, const brace_stereo_frame* frame) {
  broken* self = object;
  const brace_result result = broken_misbehave(self);
  if (result != BRACE_OK) return result;
  copy(self, frame->commands, &frame->left_image, &frame->right_image);
  copy(self, frame->commands, &frame->left_depth_m, &frame->right_depth_m);
  if (self->defect == BROKEN_COLOUR_OVER_OPACITY)
    fill(self, frame->commands, &frame->right_image, 0x800000ffu);
  if (self->defect == BROKEN_NOT_DETERMINISTIC) {
    fill(self, frame->commands, &frame->right_image, 0x80000000u + broken_noise_word(self));
  }
  if (self->defect == BROKEN_BAD_DEPTH) fill(self, frame->commands, &frame->right_depth_m, 0xbf800000u);
  if (self->defect == BROKEN_CHANGES_INPUT)
    self->fill(frame->commands, frame->left_image.buffer, frame->left_image.offset_bytes, 4, 0x90000000u);
  return BRACE_OK;
}

const brace_stereo_functions broken_stereo_functions = {sizeof broken_stereo_functions, stereo_record};

static brace_result warp_record(void* object, const brace_warp_frame* frame) {
  broken* self = object;
  const brace_result result = broken_misbehave(self);
  if (result != BRACE_OK) return result;
  copy(self, frame->commands, &frame->eye_image, &frame->warped_image);
  if (self->defect == BROKEN_COLOUR_OVER_OPACITY)
    fill(self, frame->commands, &frame->warped_image, 0x800000ffu);
  if (self->defect == BROKEN_NOT_DETERMINISTIC) {
    fill(self, frame->commands, &frame->warped_image, 0x80000000u + broken_noise_word(self));
  }
  if (self->defect == BROKEN_CHANGES_INPUT)
    self->fill(frame->commands, frame->eye_image.buffer, frame->eye_image.offset_bytes, 4, 0x90000000u);
  return BRACE_OK;
}

const brace_warp_functions broken_warp_functions = {sizeof broken_warp_functions, warp_record};
