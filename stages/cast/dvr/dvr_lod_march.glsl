// One half of a ray in dvr_lod.glsl, which includes this twice: with LOD_NEAR up to where the coarser levels begin.
#if defined(LOD_NEAR)
#define LOD_GOES_ON (i < count && !opaque && lod_level(lod, i) == 0)
#define LOD_LEVEL 0
#define LOD_VALUE(voxel, level) brace_value(brace_fetch(voxel))
#else
#define LOD_GOES_ON (i < count && !opaque)
#define LOD_LEVEL lod_level(lod, i)
#define LOD_VALUE(voxel, level) brace_level_value(voxel, level)
#endif
  while (LOD_GOES_ON) {
    // As in dvr.glsl: while nothing is visible to any ray of the subgroup.
    while (LOD_GOES_ON) {
      const int level = LOD_LEVEL;
      const LodSample ahead = lod_sample(ray, segments, i, level);
      const float value = lod_blend(lod, i, level, LOD_VALUE(ahead.voxel, level), ahead.voxel);
      if (!subgroupAll(brace_transfer_coordinate(value) <= brace_eye.transfer.w)) break;
      BRACE_COUNT(samples, LOD_SAMPLES(lod, i, level));
      LOD_NEXT(i, level, ahead.voxel);
    }
    if (!LOD_GOES_ON) break;
    const int level = LOD_LEVEL;
    const LodSample here = lod_sample(ray, segments, i, level);
    const float coordinate =
        brace_transfer_coordinate(lod_blend(lod, i, level, LOD_VALUE(here.voxel, level), here.voxel));
    BRACE_COUNT(samples, LOD_SAMPLES(lod, i, level));
    const float x = here.part * brace_optical_depth(coordinate);
    if (x > 0.0) {
      result.depth = min(result.depth, here.t);
      const vec3 sample_colour = brace_shade(ray, here.voxel, brace_transfer_colour(coordinate));
      BRACE_COUNT(shading_fetches, BRACE_SHADE_FETCHES);
      brace_emit_segment(ray, float(i) * cast_step_voxels, (float(i) + here.part) * cast_step_voxels, sample_colour, x);
      depth += x;
      const float left = exp2(-depth);
      colour += (transmittance - left) * sample_colour;
      transmittance = left;
      i += 1 << level;
      opaque = cast_termination_opacity < 1.0 && transmittance <= 1.0 - cast_termination_opacity;
    } else {
      LOD_NEXT(i, level, here.voxel);
    }
  }
#undef LOD_GOES_ON
#undef LOD_LEVEL
#undef LOD_VALUE
