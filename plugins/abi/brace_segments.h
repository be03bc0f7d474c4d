/* Part of brace_stage.h, which includes it: what rays leave, for stages that make layers of it. */
#ifndef BRACE_SEGMENTS_H
#define BRACE_SEGMENTS_H

#ifndef BRACE_STAGE_H
#error "include brace_stage.h"
#endif

/* A stretch of a ray in which something is visible, as brace/emit.glsl tells of it. Frozen. */
typedef struct brace_segment {
  float begin_units, end_units; /* from the ray's entry; begin < end */
  float red, green, blue;       /* not premultiplied */
  float optical_depth;          /* in powers of two: the segment's transmittance is 2^-optical_depth */
} brace_segment;

/* All that one ray leaves. Frozen. */
typedef struct brace_ray_segments {
  uint32_t ray;                  /* its index */
  uint32_t count;                /* of segments; may be 0 */
  float end_units;               /* the ray's length, or where it was ended early */
  const brace_segment* segments; /* front to back; null if there are none */
} brace_ray_segments;

/* Where a cast on the host tells of segments. */
typedef struct brace_segment_sink {
  uint32_t struct_size;
  void* host_context; /* the host's own */
  /* Copies what `count` rays leave. Each ray of the area whose length is above 0 is told of once, the others
   * never. Thread: any, also several at once. What it returns other than BRACE_OK, execute returns as well.
   */
  brace_result (*take)(const struct brace_segment_sink* sink, const brace_ray_segments* rays, uint32_t count);
} brace_segment_sink;

#endif
