// The SIMD ray caster: cast/dvr's kernel with a ray in every lane. Lanes stand at different places of their
// rays; all they share is the loop. The same text is compiled for every instruction set (Google Highway) and
// chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cast_area.cpp"
#include <algorithm>
#include <cmath>
#include <limits>

// clang-format off
#include <hwy/foreach_target.h>  // first: it includes this file again for each instruction set
#include <hwy/highway.h>
// clang-format on

#include "caster.hpp"
#include "packet-inl.hpp"
#include "traversal-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

template <brace_voxel_type type>
brace_result cast_voxels(const Scene& scene, const Rays& rays, const brace_area& area,
                         brace_work_counts& counts) {
  const PacketSize size = packet_size();
  const EmptyBytes empty = empty_bytes(scene);
  thread_local Trail trail;  // grows to what the longest rays leave
  for (std::uint32_t y = 0; y < area.height; y += size.high) {
    for (std::uint32_t x = 0; x < area.width; x += size.wide) {
      const PacketRays packet = packet_at(rays, area, x, y);
      Traversal<type> traversal(scene, load(rays, packet), scene.segments != nullptr ? &trail : nullptr,
                                counts);
      traversal.go(scene, empty, counts);
      const brace_result told = traversal.store(scene, rays, packet);
      if (told != BRACE_OK) return told;
    }
  }
  return BRACE_OK;
}

brace_result cast_area_here(const Scene& scene, const Rays& rays, const brace_area& area,
                            brace_work_counts& counts) {
  switch (scene.volume->type) {
    case BRACE_VOXEL_UINT8:
      return cast_voxels<BRACE_VOXEL_UINT8>(scene, rays, area, counts);
    case BRACE_VOXEL_FLOAT32:
      return cast_voxels<BRACE_VOXEL_FLOAT32>(scene, rays, area, counts);
    case BRACE_VOXEL_INT16:
    case BRACE_VOXEL_UINT16:
      return cast_voxels<BRACE_VOXEL_UINT16>(scene, rays, area, counts);
  }
  return BRACE_UNSUPPORTED;
}

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace native_cast {

namespace {

struct InstructionSet {
  const char* name;
  std::int64_t target;
};

// Best first. The last is plain C++, a ray at a time.
constexpr InstructionSet sets[] = {
    {"avx512", HWY_AVX3}, {"avx2", HWY_AVX2}, {"sse4", HWY_SSE4}, {"neon", HWY_NEON}, {"scalar", HWY_SCALAR}};

bool is_there(const InstructionSet& set) {
  hwy::SetSupportedTargetsForTest(0);  // what the processor can
  return set.target == HWY_STATIC_TARGET || (set.target & HWY_TARGETS & hwy::SupportedTargets()) != 0;
}

}  // namespace

HWY_EXPORT(cast_area_here);

brace_result cast_area(const Scene& scene, const Rays& rays, const brace_area& area,
                       brace_work_counts& counts) {
  return HWY_DYNAMIC_DISPATCH(cast_area_here)(scene, rays, area, counts);
}

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const InstructionSet& set : sets) {
    if (is_there(set)) names.emplace_back(set.name);
  }
  return names;
}

void choose_instruction_set(const std::string& name) {
  for (const InstructionSet& set : sets) {
    if ((name != "auto" && name != set.name) || !is_there(set)) continue;
    hwy::SetSupportedTargetsForTest(set.target);
    return;
  }
}

}  // namespace native_cast
#endif
