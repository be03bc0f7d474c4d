// Skipping is bit-equal to not skipping; adaptive steps keep their tolerance with fewer samples.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "runtime/verify/verify.hpp"
#include "runtime/volume/generators.hpp"

namespace brace {

namespace {

constexpr int kEdge = 32;

/// Rays through the box from anywhere around it: oblique, parallel to axes, along borders between blocks.
std::vector<CastRay> rays_through(int edge, int count) {
  std::mt19937 random(5);
  const auto unit = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  std::vector<CastRay> rays;
  const auto size = static_cast<float>(edge);
  while (static_cast<int>(rays.size()) < count) {
    glm::vec3 at(unit() * size, unit() * size, unit() * size);
    glm::vec3 along(unit() - 0.5f, unit() - 0.5f, unit() - 0.5f);
    if (rays.size() % 4 == 1) along.y = 0.0f;
    if (rays.size() % 4 == 2) at = glm::floor(at);
    if (rays.size() % 8 == 3) along.x = along.z = 0.0f;
    const float norm = std::sqrt(along.x * along.x + along.y * along.y + along.z * along.z);
    if (norm < 1e-3f) continue;
    along /= norm;
    float back = 1e9f, forth = 1e9f;
    for (int axis = 0; axis < 3; ++axis) {
      if (along[axis] == 0.0f) continue;
      const float low = -at[axis] / along[axis], high = (size - at[axis]) / along[axis];
      back = std::min(back, -std::min(low, high));
      forth = std::min(forth, std::max(low, high));
    }
    const glm::vec3 entry = glm::clamp(at - back * along, glm::vec3(0.0f), glm::vec3(size));
    rays.push_back({glm::vec4(entry, back + forth), glm::vec4(along, 0.0f)});
  }
  return rays;
}

const Volume& vessels() {
  static const Volume volume = load_volume(*open_volume("generator:fractal_vessels:32"));
  return volume;
}

const Volume& waves() {
  static const Volume volume = load_volume(*open_volume("generator:marschner_lobb:32"));
  return volume;
}

/// A band that trilinear interpolation passes through and hardly a voxel has, and all above.
TransferTable band_table() {
  return make_table(
      255.0, 256, [](double v) { return v > 90 && v < 110 ? 2.0
                                        : v > 160         ? 0.5
                                                          : 0.0; },
      [](double v) { return v / 255; });
}

/// A colour and an absorption without kinks.
TransferTable smooth_table() {
  return make_table(
      255.0, 256, [](double v) { return 0.3 * std::pow(v / 255, 2); },
      [](double v) { return 0.2 + 0.6 * v / 255; });
}

std::size_t bits_that_differ(const CastResult& a, const CastResult& b) {
  std::size_t rays = 0;
  for (std::size_t i = 0; i < a.colours.size(); ++i) {
    rays += std::memcmp(&a.colours[i], &b.colours[i], sizeof(glm::vec4)) != 0 ||
            std::memcmp(&a.depths[i], &b.depths[i], sizeof(float)) != 0;
  }
  return rays;
}

double rms_error(const CastResult& result, const CastResult& exact) {
  double sum = 0.0;
  for (std::size_t i = 0; i < exact.colours.size(); ++i) {
    const glm::vec4 off = result.colours[i] - exact.colours[i];
    sum += static_cast<double>(off.x * off.x + off.y * off.y + off.z * off.z + off.w * off.w) / 4;
  }
  return std::sqrt(sum / static_cast<double>(exact.colours.size()));
}

}  // namespace

void verify_skipping(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  CastCase wanted{&vessels(), band_table(), rays_through(kEdge, 256), {}, SkipKind::none};
  const auto compare = [&](const CastRule& rule, const std::vector<SkipKind>& kinds) {
    wanted.rule = rule;
    wanted.skip = SkipKind::none;
    const CastResult whole = subjects.cast(wanted);
    for (const SkipKind kind : kinds) {
      wanted.skip = kind;
      const CastResult leapt = subjects.cast(wanted);
      const std::string name = std::string("skip/") + to_string(kind) + ", " + rule.name();
      claims.add(name + ": rays with other bits", static_cast<double>(bits_that_differ(leapt, whole)),
                 exactly(0), "of 256");
      claims.add(name + ": share of the samples taken",
                 static_cast<double>(leapt.work.samples) / static_cast<double>(whole.work.samples),
                 at_most(0.95));
    }
  };
  compare({}, {SkipKind::block, SkipKind::distance_map, SkipKind::partitioned, SkipKind::bitmask,
               SkipKind::octree});
  compare({.integrator = "left"}, {SkipKind::distance_map});
  compare({.integrator = "linear-source"}, {SkipKind::distance_map, SkipKind::octree});
  compare({.integrator = "pre-integrated", .preintegration = "table"},
          {SkipKind::block, SkipKind::distance_map});
  compare({.integrator = "pre-integrated", .preintegration = "integral"}, {SkipKind::distance_map});
  compare({.integrator = "linear-source", .tolerance = 1e-3}, {SkipKind::distance_map});
  compare({.integrator = "pre-integrated", .preintegration = "integral", .tolerance = 1e-3},
          {SkipKind::block, SkipKind::distance_map});
}

void verify_adaptive(const VerifySubjects& subjects, Claims& claims, VerifyFigures& figures) {
  CastCase wanted{&waves(), smooth_table(), rays_through(kEdge, 256), {}, SkipKind::none};
  const CastRule fixed{.integrator = "pre-integrated", .preintegration = "integral"};
  const auto at_step = [&](double step) {
    wanted.rule = fixed;
    wanted.rule.step_voxels = step;
    return subjects.cast(wanted);
  };
  const CastResult exact = at_step(1.0 / 64);
  ErrorCurve fixed_curve{"waves, 256 rays", "fixed steps", {}},
      curve{"waves, 256 rays", "adaptive steps", {}};
  for (const double step : {2.0, 1.0, 0.5, 0.25, 0.125}) {
    const CastResult result = at_step(step);
    fixed_curve.points.push_back({static_cast<double>(result.work.samples), rms_error(result, exact)});
  }
  double samples_before = 0.0;
  for (const double tolerance : {1e-2, 1e-3, 3e-4}) {
    wanted.rule = fixed;
    wanted.rule.tolerance = tolerance;
    const CastResult result = subjects.cast(wanted);
    const auto samples = static_cast<double>(result.work.samples);
    curve.points.push_back({samples, rms_error(result, exact)});
    claims.add(fmt::format("tolerance {:g}: RMS error / tolerance", tolerance),
               rms_error(result, exact) / tolerance, at_most(1.0));
    if (samples_before > 0)
      claims.add(fmt::format("tolerance {:g}: samples against the looser one before", tolerance),
                 samples / samples_before, at_least(1.05));
    samples_before = samples;
  }
  figures.curves.push_back(fixed_curve);
  figures.curves.push_back(curve);
}

}  // namespace brace
