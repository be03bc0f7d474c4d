#include "runtime/metrics/image_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr int channels = 3;
constexpr double c1 = (0.01 * 255.0) * (0.01 * 255.0);
constexpr double c2 = (0.03 * 255.0) * (0.03 * 255.0);
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Row = std::vector<int>;

template <typename Pixel>
void require_same_size(const Image<Pixel>& shown, const Image<Pixel>& reference,
                       std::span<const std::uint8_t> visible) {
  if (shown.width_px != reference.width_px || shown.height_px != reference.height_px) {
    throw input_error("image error: the picture has {}x{} pixels, its reference {}x{}; both must be equal",
                      shown.width_px, shown.height_px, reference.width_px, reference.height_px);
  }
  if (!visible.empty() && visible.size() != shown.pixels.size()) {
    throw input_error("image error: the mask has {} pixels, the picture {}x{} = {}; both must be equal",
                      visible.size(), shown.width_px, shown.height_px, shown.pixels.size());
  }
}

// One row of both pictures, channels apart, hidden pixels set to zero so that they add nothing to any sum.
struct PixelRow {
  explicit PixelRow(int width)
      : shown(static_cast<std::size_t>(width * channels)),
        reference(static_cast<std::size_t>(width * channels)),
        count(static_cast<std::size_t>(width)) {}
  std::vector<std::int16_t> shown, reference;  // channel-major: c * width + x
  Row count;                                   // 1 where visible
};

struct Pictures {
  const ImageRgba8& shown;
  const ImageRgba8& reference;
  std::span<const std::uint8_t> visible;

  void load(int y, PixelRow& row) const {
    const auto width = static_cast<std::size_t>(shown.width_px);
    const std::size_t first = static_cast<std::size_t>(y) * width;
    for (std::size_t x = 0; x < width; ++x) {
      const int in = visible.empty() || visible[first + x] != 0 ? 0xff : 0;
      const Rgba8 s = shown.pixels[first + x];
      const Rgba8 r = reference.pixels[first + x];
      row.count[x] = in & 1;
      row.shown[x] = static_cast<std::int16_t>(s.r & in);
      row.shown[width + x] = static_cast<std::int16_t>(s.g & in);
      row.shown[2 * width + x] = static_cast<std::int16_t>(s.b & in);
      row.reference[x] = static_cast<std::int16_t>(r.r & in);
      row.reference[width + x] = static_cast<std::int16_t>(r.g & in);
      row.reference[2 * width + x] = static_cast<std::int16_t>(r.b & in);
    }
  }
};

// The sums SSIM needs, of each column over the window's rows, or of each window of a row. Exact: with 64
// pixels of 8 bits nothing here, nor n times it, leaves an int.
struct Sums {
  explicit Sums(std::size_t size) : shown(size), reference(size), squares(size), products(size) {}
  Row shown, reference, squares, products;  // sums of s, r, s^2 + r^2, s r
};

// `__restrict` here and below: these loops are the whole cost, and the compiler takes two lanes only when
// told that the rows do not overlap.
template <int sign>
void add_row(const PixelRow& row, Sums& columns, Row& counts) {
  const std::int16_t* __restrict shown = row.shown.data();
  const std::int16_t* __restrict reference = row.reference.data();
  int* __restrict sum_shown = columns.shown.data();
  int* __restrict sum_reference = columns.reference.data();
  int* __restrict sum_squares = columns.squares.data();
  int* __restrict sum_products = columns.products.data();
  for (std::size_t i = 0; i < row.shown.size(); ++i) {
    const int s = shown[i];
    const int r = reference[i];
    sum_shown[i] += sign * s;
    sum_reference[i] += sign * r;
    sum_squares[i] += sign * (s * s + r * r);
    sum_products[i] += sign * (s * r);
  }
  for (std::size_t i = 0; i < counts.size(); ++i)
    counts[i] += sign * row.count[i];
}

// out[x] = sum of columns[x .. x + window). The log-step form needs three additions for a window of 8 and
// no chain of dependent ones; a picture smaller than the window takes the plain form.
void sum_windows(const int* __restrict columns, int window, std::size_t windows, int* __restrict out,
                 Row& pairs, Row& quads) {
  if (window != ssim_window_px) {
    for (std::size_t x = 0; x < windows; ++x) {
      out[x] = 0;
      for (int k = 0; k < window; ++k)
        out[x] += columns[x + static_cast<std::size_t>(k)];
    }
    return;
  }
  pairs.resize(windows + 6);
  quads.resize(windows + 4);
  for (std::size_t x = 0; x < windows + 6; ++x)
    pairs[x] = columns[x] + columns[x + 1];
  for (std::size_t x = 0; x < windows + 4; ++x)
    quads[x] = pairs[x] + pairs[x + 2];
  for (std::size_t x = 0; x < windows; ++x)
    out[x] = quads[x] + quads[x + 4];
}

// SSIM of each window from its n pixels' sums, numerator and denominator both times n^4: everything up to the
// two constants is an integer below 2^53, so exact in double (which multiplies faster than int where there
// is no AVX). n = 0 gives 1, which then weighs nothing.
void ssim_of_windows(const Sums& sums, const Row& counts, std::span<double> out) {
  const int* __restrict count = counts.data();
  const int* __restrict shown = sums.shown.data();
  const int* __restrict reference = sums.reference.data();
  const int* __restrict squares = sums.squares.data();
  const int* __restrict products = sums.products.data();
  double* __restrict result = out.data();
  for (std::size_t x = 0; x < out.size(); ++x) {
    const double n = count[x];
    const double s = shown[x];
    const double r = reference[x];
    const double means_product = 2.0 * s * r;
    const double means_squares = s * s + r * r;
    const double covariance = 2.0 * n * products[x] - means_product;
    const double variances = n * squares[x] - means_squares;
    const double area = n * n + (n == 0.0 ? 1.0 : 0.0);
    result[x] = (means_product + area * c1) * (covariance + area * c2) /
                ((means_squares + area * c1) * (variances + area * c2));
  }
}

// Calls visit(channel, y, ssim values of the windows whose upper row is y, their visible pixels).
template <typename Visit>
void for_each_window_row(const Pictures& pictures, const Visit& visit) {
  const int width = pictures.shown.width_px;
  const int height = pictures.shown.height_px;
  if (width <= 0 || height <= 0) return;
  const int window_w = std::min(ssim_window_px, width);
  const int window_h = std::min(ssim_window_px, height);
  const auto windows = static_cast<std::size_t>(width - window_w) + 1;

  PixelRow row(width);
  Sums columns(static_cast<std::size_t>(width * channels));
  Row column_counts(static_cast<std::size_t>(width));
  Sums sums(windows);
  Row counts(windows), pairs, quads;
  std::vector<double> values(windows);

  for (int y = 0; y < height; ++y) {
    pictures.load(y, row);
    add_row<1>(row, columns, column_counts);
    if (y + 1 < window_h) continue;
    if (y >= window_h) {
      pictures.load(y - window_h, row);
      add_row<-1>(row, columns, column_counts);
    }
    sum_windows(column_counts.data(), window_w, windows, counts.data(), pairs, quads);
    for (int c = 0; c < channels; ++c) {
      const auto first = static_cast<std::size_t>(c) * static_cast<std::size_t>(width);
      sum_windows(&columns.shown[first], window_w, windows, sums.shown.data(), pairs, quads);
      sum_windows(&columns.reference[first], window_w, windows, sums.reference.data(), pairs, quads);
      sum_windows(&columns.squares[first], window_w, windows, sums.squares.data(), pairs, quads);
      sum_windows(&columns.products[first], window_w, windows, sums.products.data(), pairs, quads);
      ssim_of_windows(sums, counts, values);
      visit(c, y + 1 - window_h, std::span<const double>(values), std::span<const int>(counts));
    }
  }
}

double psnr_db_of(double rmse) {
  return rmse == 0.0 ? std::numeric_limits<double>::infinity() : -20.0 * std::log10(rmse);
}

}  // namespace

double ssim(const ImageRgba8& shown, const ImageRgba8& reference, std::span<const std::uint8_t> visible) {
  require_same_size(shown, reference, visible);
  std::array<double, channels> sums{};
  std::int64_t weight = 0;
  for_each_window_row({shown, reference, visible},
                      [&](int c, int, std::span<const double> values, std::span<const int> counts) {
                        double sum = 0;
                        std::int64_t visible_px = 0;
                        for (std::size_t x = 0; x < values.size(); ++x) {
                          sum += counts[x] * values[x];
                          visible_px += counts[x];
                        }
                        sums[static_cast<std::size_t>(c)] += sum;
                        if (c == 0) weight += visible_px;
                      });
  if (weight == 0) return nan;
  return (sums[0] + sums[1] + sums[2]) / (channels * static_cast<double>(weight));
}

ImageError image_error(const ImageRgba8& shown, const ImageRgba8& reference,
                       std::span<const std::uint8_t> visible) {
  ImageError error;
  error.ssim = ssim(shown, reference, visible);
  error.dssim = dssim_from_ssim(error.ssim);
  const PixelError pixels = pixel_error(shown, reference, visible);
  error.psnr_db = pixels.psnr_db;
  error.rmse = pixels.rmse;
  error.max_error = pixels.max_error;
  return error;
}

ImageRgbaF dssim_map(const ImageRgba8& shown, const ImageRgba8& reference,
                     std::span<const std::uint8_t> visible) {
  require_same_size(shown, reference, visible);
  if (shown.pixels.empty()) return {};
  const auto windows_of = [](int size_px) { return size_px - std::min(ssim_window_px, size_px) + 1; };
  ImageRgbaF map(windows_of(shown.width_px), windows_of(shown.height_px));
  for_each_window_row({shown, reference, visible}, [&](int c, int y, std::span<const double> values,
                                                       std::span<const int> counts) {
    for (std::size_t x = 0; x < values.size(); ++x) {
      if (counts[x] == 0) continue;
      RgbaF& pixel = map.at(static_cast<int>(x), y);
      (c == 0 ? pixel.r : c == 1 ? pixel.g : pixel.b) = static_cast<float>(dssim_from_ssim(values[x]));
      pixel.a = 1.0f;
    }
  });
  return map;
}

PixelError pixel_error(const ImageRgba8& shown, const ImageRgba8& reference,
                       std::span<const std::uint8_t> visible) {
  require_same_size(shown, reference, visible);
  std::uint64_t squares = 0;
  std::uint64_t count = 0;
  int largest = 0;
  for (std::size_t i = 0; i < shown.pixels.size(); ++i) {
    if (!visible.empty() && visible[i] == 0) continue;
    const Rgba8 s = shown.pixels[i];
    const Rgba8 r = reference.pixels[i];
    const int dr = std::abs(s.r - r.r);
    const int dg = std::abs(s.g - r.g);
    const int db = std::abs(s.b - r.b);
    squares += static_cast<std::uint64_t>(dr * dr + dg * dg + db * db);
    largest = std::max({largest, dr, dg, db});
    ++count;
  }
  if (count == 0) return {nan, nan, nan};
  const double rmse =
      std::sqrt(static_cast<double>(squares) / (channels * static_cast<double>(count))) / 255.0;
  return {rmse, largest / 255.0, psnr_db_of(rmse)};
}

PixelError pixel_error(const ImageRgbaF& shown, const ImageRgbaF& reference,
                       std::span<const std::uint8_t> visible) {
  require_same_size(shown, reference, visible);
  double squares = 0;
  double largest = 0;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < shown.pixels.size(); ++i) {
    if (!visible.empty() && visible[i] == 0) continue;
    const RgbaF& s = shown.pixels[i];
    const RgbaF& r = reference.pixels[i];
    const double differences[] = {double{s.r} - r.r, double{s.g} - r.g, double{s.b} - r.b};
    for (const double d : differences) {
      squares += d * d;
      // Written so that a NaN stays.
      if (!(std::abs(d) <= largest)) largest = std::abs(d);
    }
    ++count;
  }
  if (count == 0) return {nan, nan, nan};
  const double rmse = std::sqrt(squares / (channels * static_cast<double>(count)));
  return {rmse, std::isnan(rmse) ? nan : largest, psnr_db_of(rmse)};
}

double weighted_rmse(const ImageRgba8& shown, const ImageRgba8& reference, std::span<const float> weights) {
  require_same_size(shown, reference, {});
  if (weights.size() != shown.pixels.size()) {
    throw input_error("image error: {} weights for a picture of {}x{} = {} pixels; both must be equal",
                      weights.size(), shown.width_px, shown.height_px, shown.pixels.size());
  }
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < shown.pixels.size(); ++i) {
    const Rgba8 s = shown.pixels[i];
    const Rgba8 r = reference.pixels[i];
    const int dr = s.r - r.r, dg = s.g - r.g, db = s.b - r.b;
    const double w = weights[i];
    sum += w * (dr * dr + dg * dg + db * db);
    weight += w;
  }
  return std::sqrt(sum / (channels * weight)) / 255.0;
}

}  // namespace brace
