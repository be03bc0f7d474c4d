#include "runtime/raycast/host_braces.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/raycast/host_braces.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // first: it includes this file again for each instruction set
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include "plugins/abi/glsl/brace/eye_params.h"

HWY_BEFORE_NAMESPACE();
namespace brace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Float = hn::Vec<Floats>;

HWY_INLINE Float all(float value) {
  return hn::Set(Floats(), value);
}

struct Axis {
  Float entry, direction, nearer, farther;
};

/// Rays of one row of cells from `x` on, a vector of them: brace_ray_through.
HWY_INLINE void open_vector(const BraceEyeParams& eye, float x, float y, float* entries, float* directions) {
  const Float px = hn::Iota(Floats(), x - eye.ray_base[3] + 0.5f);
  const Float py = all(y - eye.ray_dx[3] + 0.5f);
  Float to[3];
  Float size = hn::Zero(Floats());
  for (int i = 0; i < 3; ++i) {
    to[i] = hn::MulAdd(py, all(eye.ray_dy[i]), hn::MulAdd(px, all(eye.ray_dx[i]), all(eye.ray_base[i])));
    size = hn::MulAdd(to[i], to[i], size);
  }
  const Float inverse = hn::Div(all(1.0f), hn::Sqrt(size));
  Float direction[3], begin = hn::Zero(Floats()), end = all(0.0f);
  for (int i = 0; i < 3; ++i) {
    direction[i] = hn::Mul(hn::Mul(to[i], inverse), all(eye.voxels_per_unit[i]));
    // An axis that the ray is parallel to gets a tiny slope: no division by zero, hence no 0 * inf.
    const Float slope = hn::IfThenElse(hn::Lt(hn::Abs(direction[i]), all(1e-20f)), all(1e-20f), direction[i]);
    const Float to_low = hn::Div(all(-eye.eye[i]), slope);
    const Float to_high = hn::Div(all(eye.volume_dims[i] - eye.eye[i]), slope);
    begin = hn::Max(begin, hn::Min(to_low, to_high));
    const Float farther = hn::Max(to_low, to_high);
    end = i == 0 ? farther : hn::Min(end, farther);
  }
  Float entry[3];
  for (int i = 0; i < 3; ++i) {
    const Float at = hn::MulAdd(begin, direction[i], all(eye.eye[i]));
    entry[i] = hn::Min(hn::Max(at, hn::Zero(Floats())), all(eye.volume_dims[i]));
  }
  const Float extent = hn::Max(hn::Sub(end, begin), hn::Zero(Floats()));
  hn::StoreInterleaved4(entry[0], entry[1], entry[2], extent, Floats(), entries);
  hn::StoreInterleaved4(direction[0], direction[1], direction[2], hn::Zero(Floats()), Floats(), directions);
}

constexpr std::size_t lanes_max = HWY_MAX_BYTES / 4;

/// `count` rays of a row.
void open_row(const BraceEyeParams& eye, std::uint32_t x, std::uint32_t y, std::uint32_t count,
              float* entries, float* directions) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(Floats()));
  const auto row = static_cast<float>(y);
  std::uint32_t i = 0;
  for (; i + lanes <= count; i += lanes)
    open_vector(eye, static_cast<float>(x + i), row, entries + 4 * std::size_t{i},
                directions + 4 * std::size_t{i});
  if (i == count) return;
  HWY_ALIGN float last[2][4 * lanes_max];
  open_vector(eye, static_cast<float>(x + i), row, last[0], last[1]);
  std::copy_n(last[0], 4 * std::size_t{count - i}, entries + 4 * std::size_t{i});
  std::copy_n(last[1], 4 * std::size_t{count - i}, directions + 4 * std::size_t{i});
}

/// Premultiplied RGBA8 of a vector of colours: packUnorm4x8.
HWY_INLINE void close_vector(const float* colours, std::uint32_t* pixels) {
  Float channel[4];
  hn::LoadInterleaved4(Floats(), colours, channel[0], channel[1], channel[2], channel[3]);
  const hn::RebindToSigned<Floats> ints;
  auto packed = hn::Zero(ints);
  for (int c = 3; c >= 0; --c) {
    const Float limited = hn::Min(hn::Max(channel[c], hn::Zero(Floats())), all(1.0f));
    packed = hn::Or(hn::ShiftLeft<8>(packed), hn::NearestInt(hn::Mul(limited, all(255.0f))));
  }
  const hn::RebindToUnsigned<Floats> words;
  hn::StoreU(hn::BitCast(words, packed), words, pixels);
}

void close_row(const float* colours, std::uint32_t count, std::uint32_t* pixels) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(Floats()));
  std::uint32_t i = 0;
  for (; i + lanes <= count; i += lanes)
    close_vector(colours + 4 * std::size_t{i}, pixels + i);
  if (i == count) return;
  HWY_ALIGN float last[4 * lanes_max] = {};
  HWY_ALIGN std::uint32_t packed[lanes_max];
  std::copy_n(colours + 4 * std::size_t{i}, 4 * std::size_t{count - i}, last);
  close_vector(last, packed);
  std::copy_n(packed, count - i, pixels + i);
}

}  // namespace HWY_NAMESPACE
}  // namespace brace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brace {

HWY_EXPORT(open_row);
HWY_EXPORT(close_row);

namespace {

template <typename Element>
Element* mapped(const gpu::Buffer& buffer) {
  return reinterpret_cast<Element*>(buffer.mapped().data());
}

/// Calls row(y) for the rows of an area on all threads; how long that took.
template <typename Row>
SimDuration for_each_row(const CastArea& area, const Row& row) {
  const auto begin = std::chrono::steady_clock::now();
  constexpr int rows_at_a_time = 16;
  tbb::parallel_for(tbb::blocked_range<int>(area.y, area.y + area.height, rows_at_a_time),
                    [&](const tbb::blocked_range<int>& rows) {
                      for (int y = rows.begin(); y < rows.end(); ++y)
                        row(static_cast<std::uint32_t>(y));
                    });
  return std::chrono::steady_clock::now() - begin;
}

}  // namespace

bool maps_braces(const CastPipeline::Resources& in) {
  const auto is_mapped = [](const gpu::Buffer& buffer) { return buffer.is_mapped(); };
  return is_mapped(in.target.params) && is_mapped(in.rays.entries) && is_mapped(in.rays.directions) &&
         is_mapped(in.rays.colours) && is_mapped(in.rays.depths_m) && is_mapped(in.target.image) &&
         is_mapped(in.target.depth);
}

SimDuration open_on_host(const CastPipeline::Resources& in, const CastArea& area) {
  const auto& eye = *mapped<const BraceEyeParams>(in.target.params);
  const auto x = static_cast<std::uint32_t>(area.x), count = static_cast<std::uint32_t>(area.width);
  float* const entries = mapped<float>(in.rays.entries);
  float* const directions = mapped<float>(in.rays.directions);
  return for_each_row(area, [&](std::uint32_t y) {
    const std::size_t first = 4 * (std::size_t{y} * eye.grid[0] + x);
    HWY_DYNAMIC_DISPATCH(open_row)(eye, x, y, count, entries + first, directions + first);
  });
}

SimDuration close_on_host(const CastPipeline::Resources& in, const CastArea& area) {
  const auto& eye = *mapped<const BraceEyeParams>(in.target.params);
  const auto left = static_cast<std::uint32_t>(eye.ray_base[3]),
             top = static_cast<std::uint32_t>(eye.ray_dx[3]);
  const auto x = static_cast<std::uint32_t>(area.x), count = static_cast<std::uint32_t>(area.width);
  return for_each_row(area, [&](std::uint32_t y) {
    const std::size_t ray = std::size_t{y + top} * eye.grid[0] + x + left;
    const std::size_t pixel = std::size_t{y} * eye.grid[2] + x;
    HWY_DYNAMIC_DISPATCH(close_row)
    (mapped<const float>(in.rays.colours) + 4 * ray, count, mapped<std::uint32_t>(in.target.image) + pixel);
    std::copy_n(mapped<const float>(in.rays.depths_m) + ray, count, mapped<float>(in.target.depth) + pixel);
  });
}

}  // namespace brace
#endif
