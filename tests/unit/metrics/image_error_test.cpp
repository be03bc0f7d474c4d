#include "runtime/metrics/image_error.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace {
namespace {

ImageRgba8 constant(int width, int height, int value) {
  ImageRgba8 image(width, height);
  const auto v = static_cast<std::uint8_t>(value);
  std::fill(image.pixels.begin(), image.pixels.end(), Rgba8{v, v, v, 255});
  return image;
}

ImageRgba8 noise(int width, int height, unsigned seed, int low = 0, int high = 255) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> value(low, high);
  ImageRgba8 image(width, height);
  for (Rgba8& p : image.pixels) {
    p = {static_cast<std::uint8_t>(value(random)), static_cast<std::uint8_t>(value(random)),
         static_cast<std::uint8_t>(value(random)), 255};
  }
  return image;
}

std::vector<std::uint8_t> random_mask(const ImageRgba8& image, unsigned seed, double visible_share) {
  std::mt19937 random(seed);
  std::bernoulli_distribution is_visible(visible_share);
  std::vector<std::uint8_t> mask(image.pixels.size());
  for (auto& m : mask)
    m = is_visible(random) ? 1 : 0;
  return mask;
}

double channel_of(const Rgba8& p, int c) {
  return c == 0 ? p.r : c == 1 ? p.g : p.b;
}

// Wang 2004, eq. 13, from the definition: two passes over the visible pixels of one window.
double window_ssim(const ImageRgba8& a, const ImageRgba8& b, const std::vector<std::uint8_t>& mask, int c,
                   int x0, int y0, int w, int h, int& visible) {
  const auto in = [&](int x, int y) {
    return mask.empty() || mask[static_cast<std::size_t>(y * a.width_px + x)] != 0;
  };
  double mean_a = 0, mean_b = 0;
  visible = 0;
  for (int y = y0; y < y0 + h; ++y) {
    for (int x = x0; x < x0 + w; ++x) {
      if (!in(x, y)) continue;
      mean_a += channel_of(a.at(x, y), c);
      mean_b += channel_of(b.at(x, y), c);
      ++visible;
    }
  }
  if (visible == 0) return 0;
  mean_a /= visible;
  mean_b /= visible;
  double var_a = 0, var_b = 0, cov = 0;
  for (int y = y0; y < y0 + h; ++y) {
    for (int x = x0; x < x0 + w; ++x) {
      if (!in(x, y)) continue;
      const double da = channel_of(a.at(x, y), c) - mean_a;
      const double db = channel_of(b.at(x, y), c) - mean_b;
      var_a += da * da / visible;
      var_b += db * db / visible;
      cov += da * db / visible;
    }
  }
  const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
  return (2 * mean_a * mean_b + c1) * (2 * cov + c2) /
         ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2));
}

double brute_force_ssim(const ImageRgba8& a, const ImageRgba8& b,
                        const std::vector<std::uint8_t>& mask = {}) {
  const int w = std::min(8, a.width_px), h = std::min(8, a.height_px);
  double total = 0, weight = 0;
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y + h <= a.height_px; ++y) {
      for (int x = 0; x + w <= a.width_px; ++x) {
        int visible = 0;
        const double value = window_ssim(a, b, mask, c, x, y, w, h, visible);
        total += value * visible;
        weight += visible;
      }
    }
  }
  return total / weight;
}

TEST(ImageError, Constants100Against110GiveTheClosedForm) {
  const ImageError e = image_error(constant(24, 17, 100), constant(24, 17, 110));
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(e.ssim, (2 * 100.0 * 110.0 + c1) / (100.0 * 100.0 + 110.0 * 110.0 + c1), 1e-15);
  EXPECT_NEAR(e.ssim, 0.99547644, 5e-9);
  EXPECT_DOUBLE_EQ(e.dssim, (1 - e.ssim) / 2);
  EXPECT_DOUBLE_EQ(e.rmse, 10.0 / 255.0);
  EXPECT_DOUBLE_EQ(e.max_error, 10.0 / 255.0);
  EXPECT_NEAR(e.psnr_db, 20 * std::log10(25.5), 1e-12);
}

TEST(ImageError, IdenticalPicturesAreExactlyOneAndInfiniteDecibels) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const ImageRgba8 image = noise(40 + static_cast<int>(seed), 33, seed);
    const ImageError e = image_error(image, image, random_mask(image, seed, 0.7));
    EXPECT_EQ(e.ssim, 1.0);
    EXPECT_EQ(e.dssim, 0.0);
    EXPECT_EQ(e.rmse, 0.0);
    EXPECT_EQ(e.max_error, 0.0);
    EXPECT_TRUE(std::isinf(e.psnr_db) && e.psnr_db > 0);
  }
}

TEST(ImageError, IsSymmetricAndBounded) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const ImageRgba8 a = noise(31, 22, seed);
    ImageRgba8 b = a;
    for (Rgba8& p : b.pixels) {  // the negative: SSIM well below zero
      p = {static_cast<std::uint8_t>(255 - p.r), static_cast<std::uint8_t>(255 - p.g), p.b, 255};
    }
    const ImageError ab = image_error(a, b);
    const ImageError ba = image_error(b, a);
    EXPECT_EQ(ab.ssim, ba.ssim);
    EXPECT_EQ(ab.rmse, ba.rmse);
    EXPECT_LT(ab.ssim, 0.0);
    EXPECT_GE(ab.ssim, -1.0);
    EXPECT_GE(ab.dssim, 0.0);
    EXPECT_LE(ab.dssim, 1.0);
  }
}

TEST(ImageError, SlidingSumsEqualTheDefinitionInDouble) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const int width = 9 + static_cast<int>(seed) * 3, height = 8 + static_cast<int>(seed % 5) * 4;
    // Bright and nearly flat is the case that E[x^2] - mu^2 in fp32 gets wrong.
    const bool flat = seed % 2 == 0;
    const ImageRgba8 a = noise(width, height, seed, flat ? 250 : 0, 255);
    const ImageRgba8 b = noise(width, height, seed + 100, flat ? 250 : 0, 255);
    EXPECT_NEAR(ssim(a, b), brute_force_ssim(a, b), 1e-12) << seed;
  }
}

TEST(ImageError, MaskedWindowsEqualTheDefinitionOverVisiblePixels) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const ImageRgba8 a = noise(25, 19, seed), b = noise(25, 19, seed + 50, 100, 200);
    const auto mask = random_mask(a, seed, seed < 6 ? 0.6 : 0.02);
    EXPECT_NEAR(ssim(a, b, mask), brute_force_ssim(a, b, mask), 1e-12) << seed;
  }
}

TEST(ImageError, HiddenPixelsNeverCount) {
  const ImageRgba8 a = noise(40, 30, 1), b = noise(40, 30, 2);
  const auto mask = random_mask(a, 3, 0.5);
  ImageRgba8 spoiled = a;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0) spoiled.pixels[i] = {0, 255, 17, 0};
  }
  const ImageError clean = image_error(a, b, mask), same = image_error(spoiled, b, mask);
  EXPECT_EQ(clean.ssim, same.ssim);
  EXPECT_EQ(clean.rmse, same.rmse);
  EXPECT_EQ(clean.max_error, same.max_error);
  EXPECT_NE(image_error(a, b).ssim, image_error(spoiled, b).ssim);
}

TEST(ImageError, AMaskOfOnesIsNoMask) {
  const ImageRgba8 a = noise(20, 20, 1), b = noise(20, 20, 2);
  EXPECT_DOUBLE_EQ(ssim(a, b), ssim(a, b, std::vector<std::uint8_t>(400, 255)));
}

TEST(ImageError, AlphaNeverCounts) {
  const ImageRgba8 a = noise(20, 20, 1);
  ImageRgba8 b = a;
  for (Rgba8& p : b.pixels)
    p.a = 3;
  EXPECT_EQ(image_error(a, b).ssim, 1.0);
  EXPECT_EQ(image_error(a, b).max_error, 0.0);
}

TEST(ImageError, PicturesSmallerThanTheWindowUseTheirOwnSize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 20}, {20, 3}, {7, 7}, {8, 8}, {1, 9}}) {
    const ImageRgba8 a = noise(width, height, 1), b = noise(width, height, 2);
    EXPECT_NEAR(ssim(a, b), brute_force_ssim(a, b), 1e-12) << width << "x" << height;
  }
}

TEST(ImageError, NothingToCompareIsNaN) {
  EXPECT_TRUE(std::isnan(image_error(ImageRgba8(), ImageRgba8()).dssim));
  const ImageRgba8 a = noise(10, 10, 1);
  const ImageError e = image_error(a, a, std::vector<std::uint8_t>(100, 0));
  EXPECT_TRUE(std::isnan(e.ssim) && std::isnan(e.rmse) && std::isnan(e.psnr_db) && std::isnan(e.max_error));
}

TEST(ImageError, DifferentSizesAreBadInputThatNamesBoth) {
  try {
    image_error(noise(10, 10, 1), noise(10, 11, 1));
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
    EXPECT_NE(std::string(e.what()).find("10x11"), std::string::npos);
  }
  const ImageRgba8 a = noise(10, 10, 1);
  EXPECT_THROW(ssim(a, a, std::vector<std::uint8_t>(99, 1)), Error);
}

TEST(ImageError, MapHoldsEachWindowsDssimAndItsMeanIsThePictures) {
  const ImageRgba8 a = noise(30, 21, 1), b = noise(30, 21, 2);
  const ImageRgbaF map = dssim_map(a, b);
  ASSERT_EQ(map.width_px, 23);
  ASSERT_EQ(map.height_px, 14);
  double mean = 0;
  for (const RgbaF& p : map.pixels)
    mean += (double{p.r} + p.g + p.b) / (3.0 * 23.0 * 14.0);
  EXPECT_NEAR(mean, image_error(a, b).dssim, 1e-6);
  int visible = 0;
  EXPECT_NEAR(map.at(5, 3).g, (1 - window_ssim(a, b, {}, 1, 5, 3, 8, 8, visible)) / 2, 1e-6);
  EXPECT_EQ(map.at(0, 0).a, 1.0f);
}

TEST(ImageError, MapIsEmptyWhereNothingIsVisible) {
  const ImageRgba8 a = noise(24, 16, 1), b = noise(24, 16, 2);
  std::vector<std::uint8_t> mask(a.pixels.size());
  for (std::size_t y = 0; y < 16; ++y)
    std::fill_n(mask.begin() + static_cast<std::ptrdiff_t>(y * 24), 4, 1);
  const ImageRgbaF map = dssim_map(a, b, mask);
  EXPECT_EQ(map.at(3, 0).a, 1.0f);
  EXPECT_GT(map.at(3, 0).r, 0.0f);
  EXPECT_EQ(map.at(4, 0).a, 0.0f);
  EXPECT_EQ(map.at(4, 0).r, 0.0f);
}

TEST(ImageError, FloatPicturesGiveTheErrorOfTheirValues) {
  ImageRgbaF a(4, 2), b(4, 2);
  b.at(1, 1).g = 0.5f;
  const PixelError e = pixel_error(a, b);
  EXPECT_DOUBLE_EQ(e.max_error, 0.5);
  EXPECT_DOUBLE_EQ(e.rmse, std::sqrt(0.25 / 24.0));
  EXPECT_TRUE(std::isinf(pixel_error(a, a).psnr_db));
  a.at(0, 0).r = std::nanf("");
  EXPECT_TRUE(std::isnan(pixel_error(a, b).max_error));
  EXPECT_TRUE(std::isnan(pixel_error(a, b).rmse));
}

}  // namespace
}  // namespace brace
