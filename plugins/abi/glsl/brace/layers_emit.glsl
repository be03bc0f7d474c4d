// Cuts rays into layers of emission and absorption (Buchacher 2017, Algorithm 7, after Lochmann et al. 2014), for the
// cast kernel. Unlike as printed, what is open when the ray ends is written, and a layer has a begin of its own: empty
// stretches between layers belong to none. Whoever includes this defines beside BRACE_LAYERS_COUNT
//   BRACE_LAYERS_SPREAD  layer i ends where the opacity passes (i / count)^spread
//   BRACE_LAYERS_GAP_M   and before a stretch longer than this without anything visible
//   BRACE_LAYERS_EQUAL   if the opacities are shares of the ray's own, which a cast before has left in its result
#define BRACE_EMIT
#include "brace/layers.glsl"

// A software device runs masked branches in full: a layer is closed in one place, when the next segment comes.
uint layers_at;
int layers_count;                // closed
float layers_base;               // units from the eye to the ray's entry
float layers_begin, layers_end;  // of the open one, units from the entry; begin < 0: none is open
float layers_depth;              // optical, in powers of two, of the open layer
float layers_left;               // its transmittance
vec3 layers_colour;              // premultiplied
float layers_depth_all;          // of the ray so far
float layers_limit;              // of that, where the open layer ends
float layers_whole;              // the opacity that thresholds are shares of

// Optical depth at which the layer that comes next ends; the last one has no end.
float layers_next_limit() {
  const float share = float(layers_count + 1) / float(BRACE_LAYERS_COUNT);
  const float opacity = layers_whole * pow(share, BRACE_LAYERS_SPREAD);
  return layers_count + 1 < BRACE_LAYERS_COUNT ? -log2(max(1.0 - opacity, 1e-30)) : 1e30;
}

void brace_emit_begin(BraceRay ray) {
  const uint index = brace_ray_index(brace_area.origin + gl_GlobalInvocationID.xy);
  layers_at = index * uint(BRACE_LAYERS_COUNT);
  layers_count = 0;
  layers_base = length((ray.entry - brace_eye.eye.xyz) / brace_eye.voxels_per_unit.xyz);
  layers_begin = -1.0;
  layers_depth = 0.0;
  layers_left = 1.0;
  layers_colour = vec3(0.0);
  layers_depth_all = 0.0;
#if defined(BRACE_LAYERS_EQUAL)
  layers_whole = brace_result_colours[index].a;  // of the cast before
#else
  layers_whole = 1.0;
#endif
  layers_limit = layers_next_limit();
}

void layers_close() {
  brace_layer_store(layers_at + uint(layers_count),
                   BraceLayer((layers_base + layers_begin) * brace_eye.eye.w, (layers_base + layers_end) * brace_eye.eye.w,
                              layers_colour, layers_depth));
  layers_count += 1;
  layers_begin = -1.0;
  layers_depth = 0.0;
  layers_left = 1.0;
  layers_colour = vec3(0.0);
  layers_limit = layers_next_limit();
}

void brace_emit_segment(BraceRay ray, float begin, float end, vec3 colour, float optical_depth) {
  if (!(end > begin)) return;
  const bool gap = (begin - layers_end) * brace_eye.eye.w > BRACE_LAYERS_GAP_M && layers_count + 1 < BRACE_LAYERS_COUNT;
  if (layers_begin >= 0.0 && (gap || layers_depth_all >= layers_limit)) layers_close();
  layers_begin = layers_begin < 0.0 ? begin : layers_begin;
  layers_end = end;
  const float depth = min(optical_depth, 1e9);
  layers_depth += depth;
  layers_depth_all += depth;
  const float left = exp2(-layers_depth);
  layers_colour += (layers_left - left) * colour;
  layers_left = left;
}

void brace_emit_end(BraceRay ray, float end) {
  if (layers_begin >= 0.0) layers_close();
  if (layers_count < BRACE_LAYERS_COUNT) brace_layer_end(layers_at + uint(layers_count));
}

#define BRACE_EMIT_NOTHING
void brace_emit_nothing() {
  brace_layer_end(brace_ray_index(brace_area.origin + gl_GlobalInvocationID.xy) * uint(BRACE_LAYERS_COUNT));
}
