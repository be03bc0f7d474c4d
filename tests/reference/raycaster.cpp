#include "tests/reference/raycaster.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "plugins/abi/glsl/brace/light_directions.h"
#include "tests/reference/integrate.hpp"

#define BRACE_TEST_TRIPLE(x, y, z) \
  std::array<double, 3> {          \
    x, y, z                        \
  }

namespace brace::reference {

namespace {

constexpr double kFlat = 1e-3;  // BRACE_SHADE_FLAT of brace/shade.glsl

glm::dvec3 spacing_in_units(const VolumeInfo& volume) {
  return glm::dvec3(volume.spacing[0], volume.spacing[1], volume.spacing[2]) / voxel_length(volume);
}

double voxel_at(const Volume& volume, int x, int y, int z) {
  const auto& dims = volume.info.dims;
  return voxel_value(volume, std::clamp(x, 0, dims[0] - 1), std::clamp(y, 0, dims[1] - 1),
                     std::clamp(z, 0, dims[2] - 1));
}

glm::dvec3 shade(const Volume& volume, const TransferTable& table, const Ray& ray, const glm::dvec3& voxel,
                 const glm::dvec3& colour, const Phong& phong) {
  const glm::dvec3 gradient = gradient_at(volume, voxel) / (table.range.max - table.range.min);
  const glm::dvec3 view = glm::normalize(ray.direction * spacing_in_units(volume.info));
  const double size = glm::length(gradient);
  const double facing = std::min((std::abs(glm::dot(gradient, view)) + kFlat) / (size + kFlat), 1.0);
  const double glint = phong.specular * std::pow(facing, phong.shininess) * size / (size + kFlat);
  return glm::min(colour * (phong.ambient + phong.diffuse * facing) + glint, glm::dvec3(1.0));
}

/// Transmittance of steps from a point in a direction; nothing absorbs outside of the volume.
double transmittance_towards(const Volume& volume, const TransferTable& table, const glm::dvec3& from,
                             const glm::dvec3& direction, int samples, double step_units) {
  const glm::dvec3 dims(volume.info.dims[0], volume.info.dims[1], volume.info.dims[2]);
  double depth = 0.0;
  for (int i = 1; i <= samples; ++i) {
    const glm::dvec3 at = from + i * step_units * direction / spacing_in_units(volume.info);
    if (glm::any(glm::lessThan(at, glm::dvec3(0.0))) || glm::any(glm::greaterThan(at, dims))) continue;
    depth += lookup(table, value_at(volume, at)).kappa * step_units;
  }
  return std::exp(-depth);
}

constexpr std::array<std::array<double, 3>, BRACE_LIGHTS_MAX> kLights = {
    {BRACE_LIGHT_DIRECTIONS(BRACE_TEST_TRIPLE)}};
constexpr std::array<std::array<double, 3>, BRACE_OCCLUSION_SAMPLES> kAround = {
    {BRACE_OCCLUSION_DIRECTIONS(BRACE_TEST_TRIPLE)}};

glm::dvec3 light_at(const Volume& volume, const TransferTable& table, const glm::dvec3& voxel,
                    const SampledLight& sampled) {
  const auto open = [&](const glm::dvec3& direction, int samples) {
    return transmittance_towards(volume, table, voxel, direction, samples, sampled.step_units);
  };
  glm::dvec3 light(0.0);
  if (sampled.shadow_ao) {
    for (const auto& d : kAround)
      light += open({d[0], d[1], d[2]}, 1);
    return light / double{BRACE_OCCLUSION_SAMPLES} * open(sampled.light, BRACE_SHADOW_SAMPLES);
  }
  const int lights = sampled.samples == 0 ? 1 : (sampled.samples + 3) / 4;
  for (int i = 0; i < lights; ++i) {
    const auto& d = kLights[static_cast<std::size_t>(i)];
    const glm::dvec3 towards(d[0], d[1], d[2]);
    light += glm::abs(towards) * open(towards, std::min(4, sampled.samples - 4 * i));
  }
  return light / static_cast<double>(lights);
}

}  // namespace

Ray ray_through_pixel(const EyeView& eye, const VolumeInfo& volume, const VolumePlacement& placement, int x,
                      int y) {
  const double across = (x + 0.5) / eye.width_px;
  const double down = (y + 0.5) / eye.height_px;
  const glm::dvec3 in_eye((1.0 - across) * eye.tan_left + across * eye.tan_right,
                          (1.0 - down) * eye.tan_top + down * eye.tan_bottom, -1.0);
  // In the volume's own frame, metres, the box is [-half, half].
  const Pose volume_from_eye = compose(inverse(placement.world_from_volume), eye.world_from_eye);
  const glm::dvec3 origin = volume_from_eye.position;
  const glm::dvec3 direction = volume_from_eye.orientation * glm::normalize(in_eye);
  const auto box = box_size_with_longest_edge(volume, placement.size_m);
  double begin = 0.0;
  double end = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * box[static_cast<std::size_t>(axis)];
    if (direction[axis] == 0.0) {
      if (std::abs(origin[axis]) > half) return {};
      continue;
    }
    const double a = (-half - origin[axis]) / direction[axis];
    const double b = (half - origin[axis]) / direction[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (end <= begin) return {};
  const glm::dvec3 size_m(box[0], box[1], box[2]);
  const glm::dvec3 dims(volume.dims[0], volume.dims[1], volume.dims[2]);
  const double unit_m = size_m.x / dims.x / spacing_in_units(volume).x;
  Ray ray;
  ray.entry = ((origin + begin * direction) / size_m + 0.5) * dims;
  ray.direction = direction / spacing_in_units(volume);
  ray.length = (end - begin) / unit_m;
  ray.distance_m = begin;
  return ray;
}

double value_at(const Volume& volume, const glm::dvec3& voxel) {
  const glm::dvec3 at = voxel - 0.5;
  const glm::dvec3 cell = glm::floor(at);
  const glm::dvec3 place = at - cell;
  const glm::ivec3 i(cell);
  double value = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1;
    const int dy = corner >> 1 & 1;
    const int dz = corner >> 2;
    value += (dx ? place.x : 1.0 - place.x) * (dy ? place.y : 1.0 - place.y) *
             (dz ? place.z : 1.0 - place.z) * voxel_at(volume, i.x + dx, i.y + dy, i.z + dz);
  }
  return value;
}

glm::dvec3 gradient_at(const Volume& volume, const glm::dvec3& voxel) {
  const glm::dvec3 dims(volume.info.dims[0], volume.info.dims[1], volume.info.dims[2]);
  const glm::dvec3 spacing = spacing_in_units(volume.info);
  glm::dvec3 gradient(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = 1.0;
    const double ahead = value_at(volume, glm::clamp(voxel + step, glm::dvec3(0.0), dims));
    const double behind = value_at(volume, glm::clamp(voxel - step, glm::dvec3(0.0), dims));
    gradient[axis] = (ahead - behind) / (2.0 * spacing[axis]);
  }
  return gradient;
}

Result cast(const Volume& volume, const TransferTable& table, const Ray& ray, const Options& options) {
  Result result;
  result.depth = std::numeric_limits<double>::infinity();
  if (ray.length <= 0.0) return result;
  const auto lit = [&](double t, const std::array<double, 3>& own) -> std::array<double, 3> {
    if (options.sampled) {
      const glm::dvec3 light = light_at(volume, table, ray.entry + t * ray.direction, *options.sampled);
      return {own[0] * light.x, own[1] * light.y, own[2] * light.z};
    }
    if (!options.phong) return own;
    const glm::dvec3 colour =
        shade(volume, table, ray, ray.entry + t * ray.direction, {own[0], own[1], own[2]}, *options.phong);
    return {colour.r, colour.g, colour.b};
  };
  const auto value = [&](double t) { return value_at(volume, ray.entry + t * ray.direction); };
  const auto medium_of = [&](double at) {
    const TransferSample here = lookup(table, at);
    return Medium<double>{here.kappa, {here.r, here.g, here.b}};
  };
  const auto medium = [&](double t) {
    Medium<double> here = medium_of(value(t));
    if (here.kappa > 0.0) here.colour = lit(t, here.colour);
    return here;
  };
  const auto segment = [&](double begin, double end) {
    constexpr int pieces = 512;
    const bool linear = options.rule == Rule::linear_source;
    auto part = linear ? linear_source(medium_of(value(begin)), medium_of(value(end)), end - begin)
                       : pre_integrated(value(begin), value(end), end - begin, medium_of, pieces);
    if (part.depth > 0.0) part.colour = lit((begin + end) / 2, part.colour);
    return part;
  };
  const bool one_sample = options.rule == Rule::midpoint || options.rule == Rule::left;
  const double place = options.rule == Rule::left ? 0.0 : 0.5;
  const auto integral = one_sample
                            ? integrate(ray.length, options.step_units, options.termination, medium, place)
                            : integrate_between(ray.length, options.step_units, options.termination, segment);
  result.colour = {integral.colour[0], integral.colour[1], integral.colour[2], integral.opacity};
  result.depth = integral.first_hit;
  result.work.rays = 1;
  result.work.samples = static_cast<std::uint64_t>(integral.samples);
  const int fetches = options.sampled && options.sampled->shadow_ao ? 38
                      : options.sampled                             ? options.sampled->samples
                      : options.phong                               ? 6
                                                                    : 0;
  result.work.shading_fetches =
      static_cast<std::uint64_t>(fetches) * static_cast<std::uint64_t>(integral.visible_samples);
  return result;
}

Picture render(const Volume& volume, const TransferTable& table, const EyeView& eye,
               const VolumePlacement& placement, const Options& options) {
  Picture picture{eye.width_px, eye.height_px, {}, {}, {}};
  for (int y = 0; y < eye.height_px; ++y) {
    for (int x = 0; x < eye.width_px; ++x) {
      const Ray ray = ray_through_pixel(eye, volume.info, placement, x, y);
      const Result result = cast(volume, table, ray, options);
      picture.colours.push_back(result.colour);
      picture.depths_m.push_back(ray.distance_m + result.depth * metres_per_unit(volume.info, placement));
      picture.work.rays += result.work.rays;
      picture.work.samples += result.work.samples;
      picture.work.shading_fetches += result.work.shading_fetches;
    }
  }
  return picture;
}

}  // namespace brace::reference
