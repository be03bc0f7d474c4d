// The segments that the rays of a packet leave, where someone asks for them.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_TRAIL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_TRAIL_INL
#undef NATIVE_CAST_TRAIL_INL
#else
#define NATIVE_CAST_TRAIL_INL
#endif

#include <vector>

#include <hwy/highway.h>

#include "lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

/// A list per lane; keeps its memory from packet to packet.
class Trail {
 public:
  void clear() {
    for (std::vector<brace_segment>& lane : lanes_)
      lane.clear();
  }

  /// A segment for each lane of `visible`.
  HWY_NOINLINE void add(Mask visible, Float begin, Float end, const Point& colour, Float optical_depth) {
    HWY_ALIGN float columns[6][lanes_max];
    const Float values[6] = {begin, end, colour.x, colour.y, colour.z, optical_depth};
    for (int c = 0; c < 6; ++c)
      hn::Store(values[c], Floats(), columns[c]);
    HWY_ALIGN float is_visible[lanes_max];
    hn::Store(hn::IfThenElseZero(visible, all(1.0f)), Floats(), is_visible);
    for (std::size_t lane = 0; lane < hn::Lanes(Floats()); ++lane) {
      if (is_visible[lane] == 0.0f) continue;
      lanes_[lane].push_back({columns[0][lane], columns[1][lane], columns[2][lane], columns[3][lane],
                              columns[4][lane], columns[5][lane]});
    }
  }

  /// Tells of the first `count` lanes' rays that have a length.
  brace_result tell(const brace_segment_sink& sink, const std::int32_t* rays, std::size_t count, Float extent,
                    Float end) const {
    HWY_ALIGN float extents[lanes_max] = {}, ends[lanes_max] = {};
    hn::Store(extent, Floats(), extents);
    hn::Store(hn::Min(end, extent), Floats(), ends);
    brace_ray_segments told[lanes_max];
    std::uint32_t rays_told = 0;
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (!(extents[lane] > 0.0f)) continue;
      told[rays_told++] = {static_cast<std::uint32_t>(rays[lane]),
                           static_cast<std::uint32_t>(lanes_[lane].size()), ends[lane], lanes_[lane].data()};
    }
    return rays_told == 0 ? BRACE_OK : sink.take(&sink, told, rays_told);
  }

 private:
  std::vector<brace_segment> lanes_[lanes_max];
};

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
