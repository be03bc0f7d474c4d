#pragma once

#include <cstdint>

namespace brace::sim {

// Random numbers from integers alone: the same on every machine, and stateless, so that a value depends on
// what it is for and not on the order of calls.

/// SplitMix64's output function (Steele, Lea, Flood 2014): a bijective mixing of 64 bits.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Random bits number `lane` of `index`, for a stream named by a number of its own.
constexpr std::uint64_t stream_of(std::uint64_t seed, std::uint64_t index) {
  return mix64(mix64(seed) + index);
}
constexpr std::uint64_t random_bits(std::uint64_t stream, std::uint64_t lane) {
  return mix64(stream + lane);
}

/// 0 <= u < 1, 53 bits.
constexpr double uniform01(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

/// Mean 0, variance 1, within +-3.47: the sum of four uniform numbers (the hash's 16-bit quarters).
constexpr double near_normal(std::uint64_t bits) {
  const std::uint64_t sum =
      (bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48);
  // Four uniforms on 0 .. 65535: mean 4 * 32767.5, variance 4 * (65536^2 - 1) / 12.
  constexpr double inverse_deviation = 1.0 / 37837.22723720648;
  return (static_cast<double>(sum) - 131070.0) * inverse_deviation;
}

}  // namespace brace::sim
