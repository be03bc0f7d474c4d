#version 460
#extension GL_EXT_control_flow_attributes : require
// One eye's panel from one eye frame: lens distortion per channel, late warp, bilinear fetch. Composed with
//   BRACE_LENS_IDENTITY | BRACE_LENS_BROWN_CONRADY | BRACE_LENS_PANOTOOLS | BRACE_LENS_VIVE
//   BRACE_ONE_FETCH      the channels share polynomial and centre: one position, one fetch
//   BRACE_ONE_CENTRE     the channels share the centre: one radius
//   BRACE_COUNTERS       count pixels whose green the source picture does not cover
//
// Software devices (Mesa 22.3) run this in rows of 8 invocations. A store costs a scalar loop over the 8 however
// wide it is, so each invocation makes four pixels and stores them at once; the panel's rows are padded to whole
// tiles, so nothing needs a bounds check. Their texel fetch is a call that gathers 32-bit texels, and nearly all
// of the time goes there.
#include "stage/parameters.glsl"
#include "brace/warp.glsl"
#include "stage/warp.glsl"

// A tile is 32 x 8 panel pixels.
layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = BRACE_SLOT_SOURCE_IMAGE) uniform usamplerBuffer brace_source_image;
layout(set = 0, binding = BRACE_SLOT_PANEL_TILES) uniform usamplerBuffer brace_panel_tiles;
layout(std430, set = 0, binding = BRACE_SLOT_PANEL_IMAGE) writeonly buffer BracePanelImage { uvec4 brace_panel_image[]; };
#ifdef BRACE_COUNTERS
layout(std430, set = 0, binding = BRACE_SLOT_DISPLAY_COUNTERS) buffer BraceDisplayCounters { uint brace_uncovered, brace_filled; };
uint uncovered = 0u, filled = 0u;
#endif

float lens_scale(uint channel, float r2) {
  const vec4 k = brace_display.lens[channel];
#if defined(BRACE_LENS_BROWN_CONRADY)
  return 1.0 + r2 * (k.x + r2 * (k.y + r2 * k.z));
#elif defined(BRACE_LENS_PANOTOOLS)
  const float r = sqrt(r2);
  return k.x + r * (k.y + r * (k.z + r * (k.w + r * brace_display.centre[channel].w)));
#elif defined(BRACE_LENS_VIVE)
  return 1.0 / (1.0 + r2 * (k.x + r2 * (k.y + r2 * k.z))) + k.w;
#else
  return 1.0;
#endif
}

#ifdef BRACE_WARP_PER_PIXEL
void warp_pixel(vec2 pixel) {
  const vec2 point = pixel * brace_display.pitch.xy + brace_display.centre[1].xy;
  const float r2 = min(dot(point, point), brace_display.centre[1].z);
  brace_warp_filled = false;
  brace_warp_pixel(point * (lens_scale(1u, r2) * brace_display.pitch.zw));
}
#endif

// A position in the source picture and whether anything is seen there.
struct Source {
  vec2 position;
  bool seen;
};

bool within(vec2 x, vec2 low, vec2 high) { return all(greaterThanEqual(x, low)) && all(lessThanEqual(x, high)); }

// Beyond the usable radius nothing is shown; the clamp keeps the lens model in its domain there.
vec2 tangents(uint channel, vec2 point, float r2) {
  return point * (lens_scale(channel, min(r2, brace_display.centre[channel].z)) * brace_display.pitch.zw);
}

vec2 source_position(vec2 tan_xy) { return brace_warp_source(tan_xy) * brace_display.source.xy + brace_display.source.zw; }

Source find_source(uint channel, vec2 point, float r2) {
  const float usable2 = brace_display.centre[channel].z;
  const vec2 tan_xy = tangents(channel, point, r2);
  Source source;
  source.position = source_position(tan_xy);
  const bool covered = within(source.position, vec2(-0.5), brace_display.source_max.zw);
#ifdef BRACE_WARP_IDENTITY
  const bool visible = r2 <= usable2;
#else
  // What the eye cannot see stays dark, even where the old picture happens to reach.
  const bool visible = r2 <= usable2 && within(tan_xy, brace_display.fov.xy, brace_display.fov.zw);
#endif
  source.seen = visible && covered;
#ifdef BRACE_COUNTERS
  if (channel == 1u && !covered && r2 <= usable2 && within(tan_xy, brace_display.fov.xy, brace_display.fov.zw))
    ++uncovered;
  if (channel == 1u && source.seen && brace_warp_filled) ++filled;
#endif
  return source;
}

// The four texels around a position, upper left, upper right, lower left, lower right, and the weights of the
// right and the lower ones. Never out of bounds: source_max keeps one texel to the right and below.
uvec4 fetch_four(vec2 position, out vec2 weight) {
  const vec2 inside = clamp(position, vec2(0.0), brace_display.source_max.xy);
  const ivec2 texel = ivec2(inside);
  weight = inside - vec2(texel);
  const int across = int(brace_display.grid.x);
  const int at = texel.y * across + texel.x;
  return uvec4(texelFetch(brace_source_image, at).x, texelFetch(brace_source_image, at + 1).x,
               texelFetch(brace_source_image, at + across).x, texelFetch(brace_source_image, at + across + 1).x);
}

// 8-bit value of one channel, in its place of the packed pixel.
uint blend(uvec4 texels, vec2 weight, uint channel, bool seen) {
  const vec4 value = vec4((texels >> (8u * channel)) & 255u);
  const vec2 rows = mix(value.xz, value.yw, weight.x);
  return (seen ? uint(mix(rows.x, rows.y, weight.y) + 0.5) : 0u) << (8u * channel);
}

#ifdef BRACE_CELL_POSES
// The cell of the source pixel that green shows from the pose of the cell at hand.
uint cell_seen(vec2 pixel) {
  const vec2 point = pixel * brace_display.pitch.xy + brace_display.centre[1].xy;
  const vec2 position = source_position(tangents(1u, point, dot(point, point))) + 0.5;
  const ivec2 texel = ivec2(clamp(position, vec2(0.0), brace_display.source_max.zw));
  return texelFetch(brace_cell_of_pixel, texel.y * int(brace_display.grid.x) + texel.x).x;
}

// A pixel shows a cell whose pose says that it does. Two guesses find it unless it lies where cells, each seen from
// where the eye is now, have come apart or overlap: there the last one counts, and as filled.
void choose_cell(vec2 pixel) {
  [[unroll]] for (uint i = 0u; i < 2u; ++i) brace_cell = cell_seen(pixel);
  brace_warp_filled = false;
#ifdef BRACE_WARP_PER_PIXEL
  warp_pixel(pixel);
#endif
  const uint seen = cell_seen(pixel);
  if (seen == brace_cell) return;
  brace_cell = seen;
#ifdef BRACE_WARP_PER_PIXEL
  warp_pixel(pixel);
#endif
  brace_warp_filled = brace_warp_filled || cell_seen(pixel) != brace_cell;
}
#endif

void set_scan(vec2 pixel) {
#if defined(BRACE_WARP_SCAN_OUT_LINES)
  brace_scan = dot(pixel, brace_display.scan.xy) + brace_display.scan.z;
#endif
}

// What is found once, for a pixel or for four.
void look_ahead(vec2 pixel) {
  set_scan(pixel);
#if defined(BRACE_CELL_POSES)
  choose_cell(pixel);
#elif defined(BRACE_WARP_PER_PIXEL)
  warp_pixel(pixel);
#endif
}

uint panel_pixel(vec2 pixel) {
  uint packed = 0xff000000u;
#if defined(BRACE_WARP_PER_FOUR)
  set_scan(pixel);
#else
  look_ahead(pixel);
#endif
#ifdef BRACE_ONE_FETCH
  const vec2 point = pixel * brace_display.pitch.xy + brace_display.centre[1].xy;
  const Source source = find_source(1u, point, dot(point, point));
  vec2 weight;
  const uvec4 texels = fetch_four(source.position, weight);
  [[unroll]] for (uint channel = 0u; channel < 3u; ++channel) packed |= blend(texels, weight, channel, source.seen);
#else
#ifdef BRACE_ONE_CENTRE
  const vec2 point = pixel * brace_display.pitch.xy + brace_display.centre[1].xy;
  const float r2 = dot(point, point);
#endif
  [[unroll]] for (uint channel = 0u; channel < 3u; ++channel) {
#ifndef BRACE_ONE_CENTRE
    const vec2 point = pixel * brace_display.pitch.xy + brace_display.centre[channel].xy;
    const float r2 = dot(point, point);
#endif
    const Source source = find_source(channel, point, r2);
    vec2 weight;
    const uvec4 texels = fetch_four(source.position, weight);
    packed |= blend(texels, weight, channel, source.seen);
  }
#endif
  return packed;
}

void main() {
  const uint tile = texelFetch(brace_panel_tiles, int(gl_WorkGroupID.x)).x;
  const uvec2 corner = uvec2(tile & 0xffffu, tile >> 16) * uvec2(32u, 8u);
  const uvec2 pixel = corner + gl_LocalInvocationID.xy * uvec2(4u, 1u);
  uvec4 four;
#if defined(BRACE_WARP_PER_FOUR)
  look_ahead(vec2(pixel) + vec2(1.5, 0.0));
#endif
  [[unroll]] for (uint i = 0u; i < 4u; ++i) {
#ifdef BRACE_COUNTERS
    const uint uncovered_before = uncovered, filled_before = filled;
#endif
    four[i] = panel_pixel(vec2(pixel + uvec2(i, 0u)));
#ifdef BRACE_COUNTERS
    // Not those of the padding.
    if (pixel.x + i >= brace_display.grid.z || pixel.y >= brace_display.grid.w) {
      uncovered = uncovered_before;
      filled = filled_before;
    }
#endif
  }
  brace_panel_image[pixel.y * brace_display.grid.y + (pixel.x >> 2)] = four;
#ifdef BRACE_COUNTERS
  if (uncovered > 0u) atomicAdd(brace_uncovered, uncovered);
  if (filled > 0u) atomicAdd(brace_filled, filled);
#endif
}
