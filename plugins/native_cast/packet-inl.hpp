// A packet of rays on its way from the ray buffers into lanes, and its results' way back.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_PACKET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_PACKET_INL
#undef NATIVE_CAST_PACKET_INL
#else
#define NATIVE_CAST_PACKET_INL
#endif

#include <algorithm>

#include <hwy/highway.h>

#include "lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

/// The rays of a packet by their index; lanes without one have the first ray's.
struct PacketRays {
  HWY_ALIGN std::int32_t index[lanes_max];
  std::size_t count = 0;
};

/// Packets are as square as the lanes allow: 4 x 4, 4 x 2, 2 x 2 or 1.
struct PacketSize {
  std::uint32_t wide, high;
};

HWY_INLINE PacketSize packet_size() {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(Floats()));
  const std::uint32_t wide = lanes >= 8 ? 4 : lanes >= 4 ? 2 : 1;
  return {wide, lanes / wide};
}

/// The rays of `area` from column x and row y of it on.
HWY_INLINE PacketRays packet_at(const Rays& rays, const brace_area& area, std::uint32_t x, std::uint32_t y) {
  const PacketSize size = packet_size();
  PacketRays packet;
  for (std::uint32_t row = y; row < std::min(y + size.high, area.height); ++row) {
    for (std::uint32_t column = x; column < std::min(x + size.wide, area.width); ++column)
      packet.index[packet.count++] =
          static_cast<std::int32_t>((area.y + row) * rays.across + area.x + column);
  }
  std::fill(packet.index + packet.count, packet.index + lanes_max, packet.index[0]);
  return packet;
}

HWY_INLINE Packet load(const Rays& rays, const PacketRays& packet) {
  const Quads entry = gather_quads(rays.entries, packet.index);
  const Quads direction = gather_quads(rays.directions, packet.index);
  Packet loaded;
  loaded.entry = {entry.column[0], entry.column[1], entry.column[2]};
  loaded.extent = hn::IfThenElseZero(hn::FirstN(Floats(), packet.count), entry.column[3]);
  loaded.direction = {direction.column[0], direction.column[1], direction.column[2]};
  return loaded;
}

struct Result {
  Point colour;
  Float optical_depth, transmittance, hit;
};

HWY_INLINE void store(const Scene& scene, const Rays& rays, const PacketRays& packet, const Packet& loaded,
                      const Result& result) {
  const auto metric = [&](Float entry, int axis) {
    return hn::Mul(hn::Sub(entry, all(scene.eye.eye[axis])), all(1.0f / scene.eye.voxels_per_unit[axis]));
  };
  const Point to{metric(loaded.entry.x, 0), metric(loaded.entry.y, 1), metric(loaded.entry.z, 2)};
  const Float length = hn::Sqrt(hn::MulAdd(to.x, to.x, hn::MulAdd(to.y, to.y, hn::Mul(to.z, to.z))));
  const Float zero = hn::Zero(Floats());
  const Float opacity = hn::Max(zero, hn::Min(hn::Sub(all(1.0f), result.transmittance), all(1.0f)));
  const auto limited = [&](Float colour) { return hn::Min(hn::Max(colour, zero), opacity); };
  scatter_quads({{limited(result.colour.x), limited(result.colour.y), limited(result.colour.z), opacity}},
                rays.colours, packet.index, packet.count);
  HWY_ALIGN float depths_m[lanes_max] = {};
  hn::Store(hn::Mul(hn::Add(length, result.hit), all(scene.eye.eye[3])), Floats(), depths_m);
  for (std::size_t lane = 0; lane < packet.count; ++lane)
    rays.depths_m[packet.index[lane]] = depths_m[lane];
}

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
