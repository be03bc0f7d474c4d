// Layers of emission and absorption along rays, for warp/volumetric and stereo/novel_view. Whoever includes this defines
//   BRACE_LAYERS_COUNT  layers per ray
// A layer in memory: begin and end in metres from the old eye as floats, premultiplied colour and optical depth (in
// powers of two) as halves. A layer that does not end behind its begin stands for none, and for none after it.
#ifndef BRACE_LAYERS_GLSL
#define BRACE_LAYERS_GLSL

layout(std430, set = 0, binding = 32) buffer BraceLayers { uvec4 brace_layer_words[]; };

struct BraceLayer {
  float begin_m, end_m;
  vec3 colour;
  float depth;
};

void brace_layer_store(uint at, BraceLayer layer) {
  // A layer thinner than the distance's last place still ends behind its begin.
  const float end_m = max(layer.end_m, uintBitsToFloat(floatBitsToUint(layer.begin_m) + 1u));
  brace_layer_words[at] = uvec4(floatBitsToUint(layer.begin_m), floatBitsToUint(end_m),
                               packHalf2x16(layer.colour.rg), packHalf2x16(vec2(layer.colour.b, min(layer.depth, 60000.0))));
}

void brace_layer_end(uint at) { brace_layer_words[at] = uvec4(0u); }

BraceLayer brace_layer_load(uint at) {
  const uvec4 words = brace_layer_words[at];
  const vec2 rg = unpackHalf2x16(words.z), b_depth = unpackHalf2x16(words.w);
  return BraceLayer(uintBitsToFloat(words.x), uintBitsToFloat(words.y), vec3(rg, b_depth.x), b_depth.y);
}

#endif
