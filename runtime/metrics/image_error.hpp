#pragma once

#include <cstdint>
#include <span>

#include "base/image.hpp"

namespace brace {

// Error of a picture against its reference, over the red, green and blue channels (alpha never counts).
// Values are fractions of full scale: 1/255 is one 8-bit step.
//
// SSIM (Wang et al. 2004) as the thesis uses it: 8x8 box window, stride 1, C1 = (0.01 L)^2, C2 = (0.03 L)^2,
// L = 255, variances over n (not n - 1). The picture's SSIM is the mean over all windows of each channel,
// then over the three channels (the thesis shows DSSIM pictures per channel and states one figure; which mean
// it took is not said). DSSIM = (1 - SSIM) / 2. All sums over a window are exact integers (fp32 E[x^2] - mu^2
// would err by up to 1.8e-3), so the result depends on the pixels alone.
//
// `visible` is the part of the panel an eye can see through the lens: one byte per pixel, row-major, non-zero
// where visible; an empty span means everywhere. Hidden pixels never count. A window that reaches over the
// border takes its means and variances from its visible pixels alone and weighs as many as it has; windows
// without any are left out. Without a mask all windows weigh the same.
//
// A picture narrower or lower than 8 pixels gets a window of its own width or height. With no pixel at all,
// or none visible, every figure is NaN. Pictures or masks of different sizes: brace::Error (exit code 2).

inline constexpr int ssim_window_px = 8;

struct ImageError {
  double ssim = 0;       // -1 .. 1; exactly 1 for identical pictures
  double dssim = 0;      // 0 .. 1
  double psnr_db = 0;    // +inf for identical pictures
  double rmse = 0;       // 0 .. 1
  double max_error = 0;  // 0 .. 1
};

ImageError image_error(const ImageRgba8& shown, const ImageRgba8& reference,
                       std::span<const std::uint8_t> visible = {});

/// SSIM alone, for both eyes of every vsync. O(pixels), independent of the window.
double ssim(const ImageRgba8& shown, const ImageRgba8& reference, std::span<const std::uint8_t> visible = {});

inline double dssim_from_ssim(double ssim_value) {
  return (1.0 - ssim_value) / 2.0;
}

/// DSSIM of each channel of each window: (width - 7) x (height - 7) pixels, the window's upper left corner at
/// the pixel's own place; a = 1 where the window has a visible pixel, else the pixel is all zero.
ImageRgbaF dssim_map(const ImageRgba8& shown, const ImageRgba8& reference,
                     std::span<const std::uint8_t> visible = {});

/// Difference of two pictures pixel by pixel. rmse and max_error of NaN input are NaN.
struct PixelError {
  double rmse = 0;
  double max_error = 0;
  double psnr_db = 0;  // of full scale 1; +inf for identical pictures
};

PixelError pixel_error(const ImageRgba8& shown, const ImageRgba8& reference,
                       std::span<const std::uint8_t> visible = {});
PixelError pixel_error(const ImageRgbaF& shown, const ImageRgbaF& reference,
                       std::span<const std::uint8_t> visible = {});

/// Root of the mean squared difference of all channels, each pixel by its weight: one per pixel, row-major,
/// not negative. NaN where they sum up to 0.
double weighted_rmse(const ImageRgba8& shown, const ImageRgba8& reference, std::span<const float> weights);

}  // namespace brace
