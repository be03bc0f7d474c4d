// Vectors with a ray in every lane, and what the casting loop does with them.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_LANES_INL
#undef NATIVE_CAST_LANES_INL
#else
#define NATIVE_CAST_LANES_INL
#endif

#include <algorithm>

#include <hwy/highway.h>

#include "caster.hpp"

HWY_BEFORE_NAMESPACE();
namespace native_cast {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;
using Word = hn::Vec<Words>;
using Mask = hn::Mask<Floats>;

constexpr std::size_t lanes_max = HWY_MAX_BYTES / 4;

HWY_INLINE Float all(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE Int all_int(std::int32_t value) {
  return hn::Set(Ints(), value);
}
HWY_INLINE Float to_float(Int value) {
  return hn::ConvertTo(Floats(), value);
}
/// Towards zero. What an int cannot hold becomes anything, without the care that ConvertTo takes of it.
HWY_INLINE Int to_int(Float value) {
#if HWY_TARGET == HWY_AVX3
  return Int{_mm512_cvttps_epi32(value.raw)};
#elif HWY_TARGET == HWY_AVX2
  return Int{_mm256_cvttps_epi32(value.raw)};
#elif HWY_TARGET == HWY_SSE4
  return Int{_mm_cvttps_epi32(value.raw)};
#else
  return hn::ConvertTo(Ints(), value);
#endif
}
HWY_INLINE Mask for_floats(hn::Mask<Ints> mask) {
  return hn::RebindMask(Floats(), mask);
}
HWY_INLINE hn::Mask<Ints> for_ints(Mask mask) {
  return hn::RebindMask(Ints(), mask);
}
HWY_INLINE bool any(Mask mask) {
  return !hn::AllFalse(Floats(), mask);
}
HWY_INLINE Mask no_lane() {
  return hn::FirstN(Floats(), 0);
}
HWY_INLINE Float lerp(Float low, Float high, Float place) {
  return hn::MulAdd(place, hn::Sub(high, low), low);
}
HWY_INLINE Word gather(const std::uint32_t* from, Int at) {
  return hn::GatherIndex(Words(), from, at);
}
HWY_INLINE Float gather(const float* from, Int at) {
  return hn::GatherIndex(Floats(), from, at);
}

struct WordPair {
  Word first, second;
};

#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
/// from[at[lane]] for each lane.
template <typename D>
HWY_INLINE hn::Vec<D> words_of(D d, const std::uint32_t* from, const std::int32_t* at) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    const auto one = [&](int lane) { return static_cast<int>(from[at[lane]]); };
    return hn::Vec<D>{_mm_setr_epi32(one(0), one(1), one(2), one(3))};
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, words_of(half, from, at + hn::MaxLanes(half)), words_of(half, from, at));
  }
}
#endif

/// Words at the same places of two arrays. On x86 lane by lane: gathers are microcode on many processors
/// (Zen 4: frames without skipping take a tenth less this way).
HWY_INLINE WordPair gather_two(const std::uint32_t* first, const std::uint32_t* second, Int at) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  HWY_ALIGN std::int32_t lanes[hn::MaxLanes(Ints())];
  hn::Store(at, Ints(), lanes);
  return {words_of(Words(), first, lanes), words_of(Words(), second, lanes)};
#else
  return {gather(first, at), gather(second, at)};
#endif
}

/// Four floats from `from` + 4 * at per lane, a vector for each.
struct Quads {
  Float column[4];
};

#if HWY_TARGET != HWY_SCALAR
/// Block b of the vector: the quad of index[4 b].
template <typename D>
HWY_INLINE hn::Vec<D> quads_of(D d, const float* from, const std::int32_t* index) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::LoadU(d, from + 4 * std::ptrdiff_t{*index});
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, quads_of(half, from, index + hn::MaxLanes(half)), quads_of(half, from, index));
  }
}
#endif

#if HWY_TARGET != HWY_SCALAR
/// Within every block of four lanes the rows become columns. The other way round, too.
HWY_INLINE Quads transpose_blocks(Float r0, Float r1, Float r2, Float r3) {
  const hn::Repartition<double, Floats> halves;
  const auto ab01 = hn::BitCast(halves, hn::InterleaveLower(Floats(), r0, r1));
  const auto cd01 = hn::BitCast(halves, hn::InterleaveUpper(Floats(), r0, r1));
  const auto ab23 = hn::BitCast(halves, hn::InterleaveLower(Floats(), r2, r3));
  const auto cd23 = hn::BitCast(halves, hn::InterleaveUpper(Floats(), r2, r3));
  return {{hn::BitCast(Floats(), hn::InterleaveLower(halves, ab01, ab23)),
           hn::BitCast(Floats(), hn::InterleaveUpper(halves, ab01, ab23)),
           hn::BitCast(Floats(), hn::InterleaveLower(halves, cd01, cd23)),
           hn::BitCast(Floats(), hn::InterleaveUpper(halves, cd01, cd23))}};
}
#endif

HWY_INLINE Quads gather_quads(const float* from, const std::int32_t* index) {
#if HWY_TARGET == HWY_SCALAR
  const float* quad = from + 4 * std::ptrdiff_t{*index};
  return {{all(quad[0]), all(quad[1]), all(quad[2]), all(quad[3])}};
#else
  // Block b of row k is the quad of lane 4 b + k.
  const auto row = [&](std::size_t k) { return quads_of(Floats(), from, index + k); };
  return transpose_blocks(row(0), row(1), row(2), row(3));
#endif
}

/// The other way round, to `to` + 4 * index for the first `count` lanes.
HWY_INLINE void scatter_quads(const Quads& columns, float* to, const std::int32_t* index, std::size_t count) {
  HWY_ALIGN float rows[4][lanes_max];
#if HWY_TARGET == HWY_SCALAR
  const Quads& turned = columns;
#else
  const Quads turned =
      transpose_blocks(columns.column[0], columns.column[1], columns.column[2], columns.column[3]);
#endif
  for (int row = 0; row < 4; ++row)
    hn::Store(turned.column[row], Floats(), rows[row]);
  for (std::size_t lane = 0; lane < count; ++lane) {
    float* const quad = to + 4 * std::ptrdiff_t{index[lane]};
#if HWY_TARGET == HWY_SCALAR
    for (int c = 0; c < 4; ++c)
      quad[c] = rows[c][0];
#else
    std::copy_n(rows[lane & 3] + (lane & ~std::size_t{3}), 4, quad);
#endif
  }
}

/// Eight floats from `from` + 8 * at per lane.
struct QuadPairs {
  Quads first, second;
};

HWY_INLINE QuadPairs gather_quad_pairs(const float* from, Int at) {
#if HWY_TARGET == HWY_AVX3
  // A load brings both quads of a lane: two lanes fill a vector.
  HWY_ALIGN std::uint32_t bytes[16];
  hn::Store(hn::BitCast(Words(), hn::ShiftLeft<5>(at)), Words(), bytes);
  asm("" : "+m"(bytes));  // else they come out of the vector one by one, which takes twice as long
  const auto pair = [&](int lane) {
    return _mm256_load_ps(reinterpret_cast<const float*>(reinterpret_cast<const char*>(from) + bytes[lane]));
  };
  const auto row = [&](int lane) {
    return Float{_mm512_insertf32x8(_mm512_castps256_ps512(pair(lane)), pair(lane + 4), 1)};
  };
  const Quads low = transpose_blocks(row(0), row(1), row(2), row(3));
  const Quads high = transpose_blocks(row(8), row(9), row(10), row(11));
  QuadPairs pairs;
  for (int c = 0; c < 4; ++c) {
    pairs.first.column[c] = Float{_mm512_shuffle_f32x4(low.column[c].raw, high.column[c].raw, 0x88)};
    pairs.second.column[c] = Float{_mm512_shuffle_f32x4(low.column[c].raw, high.column[c].raw, 0xdd)};
  }
  return pairs;
#else
  HWY_ALIGN std::int32_t index[hn::MaxLanes(Ints())];
  hn::Store(hn::Add(at, at), Ints(), index);
  return {gather_quads(from, index), gather_quads(from + 4, index)};
#endif
}

struct Point {
  Float x, y, z;
};

/// 2^-x for x >= 0, with x = 126 for all above: a polynomial of what is left to the nearest whole number (the
/// coefficients of Cephes' exp2f, relative error below 2e-7) and the exponent by its bits.
HWY_INLINE Float exp2_minus(Float x) {
  const Float limited = hn::Min(x, all(126.0f));
  const Float whole = hn::Round(limited);
  const Float f = hn::Sub(whole, limited);
  Float p = all(1.535336188319500e-4f);
  p = hn::MulAdd(p, f, all(1.339887440266574e-3f));
  p = hn::MulAdd(p, f, all(9.618437357674640e-3f));
  p = hn::MulAdd(p, f, all(5.550332471162809e-2f));
  p = hn::MulAdd(p, f, all(2.402264791363012e-1f));
  p = hn::MulAdd(p, f, all(6.931472028550421e-1f));
  p = hn::MulAdd(p, f, all(1.0f));
#if HWY_TARGET == HWY_AVX3
  return Float{_mm512_scalef_ps(p.raw, hn::Neg(whole).raw)};
#else
  const Int exponent = hn::ShiftLeft<23>(hn::Sub(all_int(127), to_int(whole)));
  return hn::Mul(p, hn::BitCast(Floats(), exponent));
#endif
}

/// A packet of rays, a lane each.
struct Packet {
  Point entry, direction;
  Float extent;
};

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
