#pragma once

#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/metrics/frame_record.hpp"
#include "runtime/raycast/eye_view.hpp"
#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

// A ray caster on the CPU in double precision, written for clarity: the oracle of the kernels. It shares the
// conventions of eye_view.hpp and transfer_function.hpp with them, and no code but the table lookup.
namespace brace::reference {

struct Phong {
  double ambient = 0.3, diffuse = 0.7, specular = 0.2, shininess = 32.0;
};

/// scene.shading = "random_lights", or with `shadow_ao` that one.
struct SampledLight {
  bool shadow_ao = false;
  int samples = 16;
  double step_units = 1.0;
  glm::dvec3 light{0.0, 1.0, 0.0};  // towards it, volume's metric axes, length 1
};

enum class Rule { midpoint, left, linear_source, pre_integrated };

struct Options {
  double step_units = 0.5;  // of the smallest voxel spacing
  double termination = 0.99;
  std::optional<Phong> phong;
  Rule rule = Rule::midpoint;
  std::optional<SampledLight> sampled = std::nullopt;
};

/// entry + t * direction, 0 <= t <= length, in voxel coordinates; t in the smallest voxel spacing.
struct Ray {
  glm::dvec3 entry{0.0};
  glm::dvec3 direction{0.0};
  double length = 0.0;
  double distance_m = 0.0;  // from the eye to the entry
};

struct Result {
  glm::dvec4 colour{0.0};  // premultiplied
  double depth = 0.0;      // from the entry to the first visible sample in units, +inf if there is none
  WorkCounts work;
};

struct Picture {
  int width_px = 0, height_px = 0;
  std::vector<glm::dvec4> colours;
  std::vector<double> depths_m;  // from the eye, +inf where nothing is visible
  WorkCounts work;
};

/// The ray through the centre of a pixel.
Ray ray_through_pixel(const EyeView& eye, const VolumeInfo& volume, const VolumePlacement& placement, int x,
                      int y);

/// Trilinear value and gradient (per unit, metric axes) at a point in voxel coordinates.
double value_at(const Volume& volume, const glm::dvec3& voxel);
glm::dvec3 gradient_at(const Volume& volume, const glm::dvec3& voxel);

Result cast(const Volume& volume, const TransferTable& table, const Ray& ray, const Options& options);

Picture render(const Volume& volume, const TransferTable& table, const EyeView& eye,
               const VolumePlacement& placement, const Options& options);

}  // namespace brace::reference
