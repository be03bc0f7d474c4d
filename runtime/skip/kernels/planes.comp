#version 460
// From a mask per block to a bit plane per partition. A work-group takes 32 blocks along x and one word of their
// masks: invocation p gathers bit p of all 32.
layout(local_size_x = 32) in;

layout(std430, binding = 1) readonly buffer Masks { uint masks[]; };     // of the slab
layout(std430, binding = 2) writeonly buffer Planes { uint planes[]; };  // from plane first_plane on
layout(push_constant) uniform Params {
  uint groups;         // of 32 blocks in the slab
  uint first_group;    // of the slab, in a plane
  uint mask_words;     // per block
  uint first_plane;    // multiple of 32 away from a word's first plane
  uint plane_count;    // planes bound, at most 32
  uint plane_stride;   // words
} params;

void main() {
  const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uint lane = gl_LocalInvocationID.x;
  if (group >= params.groups || lane >= params.plane_count) return;
  const uint word = params.first_plane / 32u;
  const uint bit = params.first_plane % 32u + lane;
  uint gathered = 0u;
  for (uint x = 0u; x < 32u; ++x) {
    const uint mask = masks[(group * 32u + x) * params.mask_words + word];
    gathered |= ((mask >> bit) & 1u) << x;
  }
  planes[lane * params.plane_stride + params.first_group + group] = gathered;
}
