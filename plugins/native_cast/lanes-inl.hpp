// Vectors with a ray in every lane, and what the casting loop does with them.
// Compiled once for every instruction set (Google Highway): the guard turns over with each.
#if defined(NATIVE_CAST_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NATIVE_CAST_LANES_INL
#undef NATIVE_CAST_LANES_INL
#else
#define NATIVE_CAST_LANES_INL
#endif

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
/// Towards zero; what a lane does not need is kept in range by its caller.
HWY_INLINE Int to_int(Float value) {
  return hn::ConvertTo(Ints(), value);
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

HWY_INLINE Quads gather_quads(const float* from, Int at) {
#if HWY_TARGET == HWY_SCALAR
  const float* quad = from + 4 * hn::GetLane(at);
  return {{all(quad[0]), all(quad[1]), all(quad[2]), all(quad[3])}};
#else
  HWY_ALIGN std::int32_t index[hn::MaxLanes(Floats())];
  hn::Store(at, Ints(), index);
  // Block b of row k is the quad of lane 4 b + k; a transposition within the blocks makes columns of them.
  const auto row = [&](std::size_t k) { return quads_of(Floats(), from, index + k); };
  const hn::Repartition<double, Floats> halves;
  const Float r0 = row(0), r1 = row(1), r2 = row(2), r3 = row(3);
  const auto ab01 = hn::BitCast(halves, hn::InterleaveLower(Floats(), r0, r1));
  const auto cd01 = hn::BitCast(halves, hn::InterleaveUpper(Floats(), r0, r1));
  const auto ab23 = hn::BitCast(halves, hn::InterleaveLower(Floats(), r2, r3));
  const auto cd23 = hn::BitCast(halves, hn::InterleaveUpper(Floats(), r2, r3));
  return {{hn::BitCast(Floats(), hn::InterleaveLower(halves, ab01, ab23)),
           hn::BitCast(Floats(), hn::InterleaveUpper(halves, ab01, ab23)),
           hn::BitCast(Floats(), hn::InterleaveLower(halves, cd01, cd23)),
           hn::BitCast(Floats(), hn::InterleaveUpper(halves, cd01, cd23))}};
#endif
}

struct Point {
  Float x, y, z;
};

/// 2^-x for x >= 0: a polynomial of the fractional part (Taylor, relative error below 1e-7) and the exponent
/// by its bits. 0 from about x = 126 on.
HWY_INLINE Float exp2_minus(Float x) {
  const Float limited = hn::Min(x, all(126.0f));
  const Float whole = hn::Floor(limited);
  const Float f = hn::Mul(hn::Sub(limited, whole), all(-0.6931471805599453f));  // 2^-fraction = e^f
  Float p = all(1.0f / 40320.0f);
  p = hn::MulAdd(p, f, all(1.0f / 5040.0f));
  p = hn::MulAdd(p, f, all(1.0f / 720.0f));
  p = hn::MulAdd(p, f, all(1.0f / 120.0f));
  p = hn::MulAdd(p, f, all(1.0f / 24.0f));
  p = hn::MulAdd(p, f, all(1.0f / 6.0f));
  p = hn::MulAdd(p, f, all(0.5f));
  p = hn::MulAdd(p, f, all(1.0f));
  p = hn::MulAdd(p, f, all(1.0f));
  const Int exponent = hn::ShiftLeft<23>(hn::Sub(all_int(127), to_int(whole)));
  const Float scaled = hn::Mul(p, hn::BitCast(Floats(), exponent));
  return hn::IfThenElse(hn::Lt(x, all(126.0f)), scaled, hn::Zero(Floats()));
}

/// A packet of rays, a lane each.
struct Packet {
  Point entry, direction, inverse_direction;
  hn::Mask<Floats> still_x, still_y, still_z;  // parallel to this axis' faces
  Float extent;
};

}  // namespace HWY_NAMESPACE
}  // namespace native_cast
HWY_AFTER_NAMESPACE();

#endif
