// The geometry of single-pass stereo, and its scan-line composition against exact solutions.
#include <cmath>

#include "runtime/verify/verify.hpp"

namespace brace {

namespace {

constexpr int kWidth_px = 64;
constexpr double kNear_m = 0.5, kFar_m = 1.25;
constexpr int kMargin = 8;  // rays beside the picture that the second eye sees content of

/// Buchacher's example: 768 px, 110 degrees, eyes 65 mm apart.
StereoOptics example_optics() {
  return {0.065, 768.0 / (2.0 * std::tan(55.0 * 3.14159265358979323846 / 180.0))};
}

double tangent(double column) {
  return column / (kWidth_px / 2.0) - 1.0;
}

StereoGeometry geometry_with(double eye_distance_m) {
  StereoGeometry geometry;
  geometry.optics = {eye_distance_m, kWidth_px / 2.0};
  geometry.disparity_px_m = eye_distance_m * geometry.optics.pixels_per_tangent;
  return geometry;
}

/// A homogeneous slab; with `pieces` every ray is cut into that many.
std::vector<std::vector<ScanSegment>> slab(double extinction_per_m, int pieces) {
  std::vector<std::vector<ScanSegment>> rays;
  const double piece_m = (kFar_m - kNear_m) / pieces;
  for (int i = -kMargin; i < kWidth_px + kMargin; ++i) {
    const double along = std::hypot(1.0, tangent(i + 0.5));
    std::vector<ScanSegment> ray;
    for (int k = 0; k < pieces; ++k)
      ray.push_back({kNear_m + k * piece_m,
                     kNear_m + (k + 1) * piece_m,
                     {1.0, 0.5, 0.25},
                     extinction_per_m * piece_m * along});
    rays.push_back(std::move(ray));
  }
  return rays;
}

PathLengths path_lengths() {
  PathLengths lengths;
  for (int i = -kMargin; i < kWidth_px + kMargin; ++i)
    lengths.per_depth_of_ray.push_back(std::hypot(1.0, tangent(i + 0.5)));
  for (int x = 0; x < kWidth_px; ++x)
    lengths.per_depth_of_column.push_back(std::hypot(1.0, tangent(x + 0.5)));
  return lengths;
}

/// Largest relative error of the slab's opacity over the row.
double slab_error(const VerifySubjects& subjects, double eye_distance_m, double extinction_per_m,
                  int pieces) {
  const auto rays = slab(extinction_per_m, pieces);
  const auto row =
      subjects.compose_scan_line(geometry_with(eye_distance_m), {-kMargin, rays}, kWidth_px, path_lengths());
  Largest error;
  for (int x = 0; x < kWidth_px; ++x) {
    const double path_m = (kFar_m - kNear_m) * std::hypot(1.0, tangent(x + 0.5));
    const double opacity = -std::expm1(-extinction_per_m * path_m);
    const glm::dvec4& got = row[static_cast<std::size_t>(x)];
    error.see(std::abs(got.w / opacity - 1.0));
    error.see(std::abs(got.y / opacity - 0.5));
  }
  return error.value();
}

/// Pairs of rays in one layer that meet in a pixel of the second eye, over many phases of the pixel grids.
double rays_that_interfere(const VerifySubjects& subjects) {
  double pairs = 0.0;
  for (const double pixels_per_ray : {0.97, 1.0, 1.03}) {
    for (const double range_px : {0.0, 0.3, 1.0, 6.999, 31.5}) {
      const int layers = subjects.interference_free_layers(range_px, pixels_per_ray);
      for (double phase = 0.0; phase < 1.0; phase += 0.01)
        pairs += std::floor(phase + layers * pixels_per_ray) <= std::floor(phase + range_px);
    }
  }
  return pairs;
}

void verify_layers(const VerifySubjects& subjects, Claims& claims) {
  const StereoOptics optics = example_optics();
  claims.add("near plane of Buchacher's example for 32 px of disparity (eq. 22)",
             subjects.near_plane_m(optics, 1.0, 32.0), within(0.44645, 0.44655), "m");
  const double near_m = subjects.near_plane_m(optics, 1.0, 32.0);
  claims.add("layers a hair nearer than that: disparities 0 … 32 are 33",
             subjects.layer_count(optics, 1.0, near_m * (1.0 - 1e-9)), exactly(33));
  claims.add("layers a hair farther", subjects.layer_count(optics, 1.0, near_m * (1.0 + 1e-9)), exactly(32));
  Largest off, inverse;
  for (const double radius_m : {1e-9, 1e-3, 0.4, 1e3, 1e9}) {
    for (const double disparity_px : {1e-6, 1.0, 31.0, 1e4}) {
      const double h = subjects.near_plane_m(optics, radius_m, disparity_px);
      const double back = subjects.disparity_range_of_sphere_px(optics, radius_m, h);
      inverse.see(std::abs(back / disparity_px - 1.0));
    }
    const double sphere = subjects.disparity_range_of_sphere_px(optics, radius_m, 0.7);
    // 1/z_near - 1/z_far cancels for small spheres; the reference in quotient form does not.
    const double exact =
        optics.eye_distance_m * optics.pixels_per_tangent * (2 * radius_m / (0.7 * (0.7 + 2 * radius_m)));
    off.see(std::abs(sphere / exact - 1.0));
  }
  claims.add("near plane and disparity are inverses, radii 1e-9 … 1e9 m, 1e-6 … 1e4 px", inverse.value(),
             at_most(1e-12));
  claims.add("disparity of a sphere, radii 1e-9 … 1e9 m (eq. 21 without cancellation)", off.value(),
             at_most(1e-12));
  claims.add("disparity to infinity is s e h / z (eq. 19), error",
             std::abs(subjects.disparity_range_px(optics, 0.5, std::numeric_limits<double>::infinity()) -
                      optics.eye_distance_m * optics.pixels_per_tangent / 0.5),
             at_most(1e-12), "px");
  claims.add("rays of one layer that meet in a pixel", rays_that_interfere(subjects), exactly(0));
}

}  // namespace

void verify_stereo(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  verify_layers(subjects, claims);
  Largest whole, cut;
  for (const double extinction_per_m : {1e-12, 0.3, 4.0, 1e12}) {
    whole.see(slab_error(subjects, 0.065, extinction_per_m, 1));
    cut.see(slab_error(subjects, 0.065, extinction_per_m, 7));
  }
  claims.add("second eye of a homogeneous slab, κ 1e-12 … 1e12 per m, relative error", whole.value(),
             at_most(1e-9));
  claims.add("the same with every ray in seven segments", cut.value(), at_most(1e-9));
  claims.add("eyes in one place, relative error", slab_error(subjects, 0.0, 2.0, 5), at_most(1e-12));
}

}  // namespace brace
