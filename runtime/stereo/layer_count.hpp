#pragma once

#include <cstdint>

namespace brace {

// How many re-projection layers a stereo pair needs (Buchacher, section 4.2). Symbols of the source: e the
// distance of the eyes, w pixels across, alpha half the horizontal angle, h the distance of the near plane, r
// the radius of the volume's bounding sphere, s pixels per metre on the near plane.
//
// One ray of the first eye writes to the pixels of the second that its points between near and far plane fall
// on. Layers are handed out to rays in turn, so there must be as many as one ray has pixels.

struct StereoOptics {
  double eye_distance_m = 0.0;      // e
  double pixels_per_tangent = 0.0;  // w / (2 tan alpha), of the second eye
};

/// Pixels between the points at both distances on one ray: s (e h / z_near - e h / z_far), eqs. 14, 17 and
/// 20, written without h. `z_far_m` may be infinite (eq. 19); 0 < z_near_m <= z_far_m.
double disparity_range_px(const StereoOptics& optics, double z_near_m, double z_far_m);

/// s d_r of eq. 21 for a sphere that touches the near plane, as 2 r e / (h + 2 r): nothing cancels.
double disparity_range_of_sphere_px(const StereoOptics& optics, double radius_m, double near_m);

/// floor(s d_r) + 1: disparities 0 … n are n + 1 layers. (The source's example, 32 layers for a near plane of
/// 0.435 m, is one short of that.)
int layer_count(const StereoOptics& optics, double radius_m, double near_m);

/// The distance h at which a sphere that touches the near plane has a disparity range of d_p pixels, beyond
/// which it has less: eq. 22 (its d is 2 r) as h = Q / (r + sqrt(r^2 + Q)), Q = e r w / (d_p tan alpha).
double near_plane_m(const StereoOptics& optics, double radius_m, double disparity_px);

/// Layers that never interfere whatever the phase of the pixel grids. A range of D pixels straddles up to
/// floor(D) + 2 pixels; `pixels_per_ray` is what neighbouring rays are apart in the second eye's picture (1
/// where both eyes have the same field of view). The least l with l pixels_per_ray >= D + 1.
int interference_free_layers(double range_px, double pixels_per_ray);

/// width height layers bytes_per_texel: w^2 l b c of the source's Table 3 for a square picture.
std::uint64_t layer_bytes(int width_px, int height_px, int layers, int bytes_per_texel);

}  // namespace brace
