// Stiff and extreme scenes through every integrator and skip stage: bounded, finite, and the same with
// skipping.
#include <cmath>
#include <cstring>

#include "runtime/verify/verify.hpp"
#include "runtime/volume/generators.hpp"

namespace brace {

namespace {

using Point = std::array<double, 3>;  // fraction of the range, grey level, kappa

struct ExtremeScene {
  std::string name;
  std::string volume;
  std::vector<Point> points;
  double opacity_min = 0.0, opacity_max = 1.0;  // of the ray through the middle
};

std::vector<ExtremeScene> scenes() {
  return {
      {"stiff_shell", "generator:nested_shells:16", {{0.48, 0.8, 0}, {0.5, 0.8, 2e6}, {0.52, 0.8, 0}}},
      {"delta_tf", "generator:marschner_lobb:16", {{0.498, 0.8, 0}, {0.502, 0.8, 500}, {0.506, 0.8, 0}}},
      {"fog_1e12", "generator:marschner_lobb:16", {{0, 0.8, 1e-12}, {0.6, 0.8, 1e-12}, {0.7, 0.5, 1e12}}},
      {"one_voxel", "generator:slab:1", {{0, 0.8, 0}, {1, 0.8, 0.7}}, 0.5, 0.51},
      {"all_empty", "generator:marschner_lobb:16", {{0, 0.8, 0}}, 0, 0},
      {"all_opaque", "generator:marschner_lobb:16", {{0, 0.2, 40}, {1, 0.8, 40}}, 0.99999, 1},
      {"needle", "generator:marschner_lobb:1x1x48", {{0.1, 0.8, 0}, {1, 0.8, 2}}},
      {"huge_gradient", "generator:solid_box:16:int16", {{0.3, 0.8, 0}, {0.9, 0.8, 4}}, 0.99, 1},
  };
}

TransferTable table_of(const Volume& volume, const ExtremeScene& scene) {
  TransferFunction function;
  function.source = scene.name;
  function.domain = ValueDomain::fraction;
  for (const auto& [value, grey, kappa] : scene.points)
    function.points.push_back({value, {grey, grey, grey, kappa}});
  const ValueRange range = scan(volume).range;
  return bake(resolve(function, range), table_layout(volume.info.type, range));
}

/// Along each axis through the middle, and across.
std::vector<CastRay> rays_through(const VolumeInfo& info) {
  const glm::vec3 dims(info.dims[0], info.dims[1], info.dims[2]);
  const glm::vec3 middle = 0.5f * dims;
  std::vector<CastRay> rays;
  for (int axis = 2; axis >= 0; --axis) {
    for (int side = 0; side < 2; ++side) {
      glm::vec3 entry = middle, along(0.0f);
      entry[axis] = side == 0 ? 0.0f : dims[axis];
      along[axis] = side == 0 ? 1.0f : -1.0f;
      rays.push_back({glm::vec4(entry, dims[axis]), glm::vec4(along, 0.0f)});
    }
  }
  for (int i = 0; i < 26; ++i) {
    // From a place on the lower face to one on the upper.
    const float u = static_cast<float>(i) / 25.0f, v = static_cast<float>(i * 7 % 26) / 25.0f;
    const glm::vec3 from(u * dims.x, v * dims.y, 0.0f), to(v * dims.x, (1 - u) * dims.y, dims.z);
    const float length = std::sqrt((to.x - from.x) * (to.x - from.x) + (to.y - from.y) * (to.y - from.y) +
                                   (to.z - from.z) * (to.z - from.z));
    rays.push_back({glm::vec4(from, length), glm::vec4((to - from) / length, 0.0f)});
  }
  // Rays that do not enter the volume, and one of no length.
  rays.push_back({glm::vec4(middle, 0.0f), glm::vec4(1, 0, 0, 0)});
  rays.push_back({glm::vec4(middle, 1e-6f), glm::vec4(0, 0, 1, 0)});
  return rays;
}

bool is_sound(const glm::vec4& c) {
  bool sound = c.a >= 0 && c.a <= 1;
  for (int i = 0; i < 3; ++i)
    sound = sound && c[i] >= 0 && c[i] <= c.a;
  return sound;
}

int rays_with_other_bits(const CastResult& a, const CastResult& b) {
  int rays = 0;
  for (std::size_t i = 0; i < a.colours.size(); ++i)
    rays += std::memcmp(&a.colours[i], &b.colours[i], sizeof(glm::vec4)) != 0;
  return rays;
}

}  // namespace

void verify_extremes(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  static std::vector<std::unique_ptr<Volume>> volumes;  // a caster knows them by address
  if (volumes.empty())
    for (const ExtremeScene& scene : scenes())
      volumes.push_back(std::make_unique<Volume>(load_volume(*open_volume(scene.volume))));
  std::vector<CastRule> rules = all_cast_rules();
  rules.push_back({.integrator = "linear-source", .tolerance = 1e-3});
  rules.push_back({.integrator = "pre-integrated", .preintegration = "integral", .tolerance = 1e-3});
  const SkipKind structures[] = {SkipKind::block, SkipKind::distance_map, SkipKind::partitioned,
                                 SkipKind::bitmask, SkipKind::octree};
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const ExtremeScene scene = scenes()[i];
    CastCase wanted{
        volumes[i].get(), table_of(*volumes[i], scene), rays_through(volumes[i]->info), {}, SkipKind::none};
    int runs = 0, unsound = 0, off_middle = 0, other_bits = 0;
    const auto judge = [&](const CastResult& result) {
      ++runs;
      for (const glm::vec4& c : result.colours)
        unsound += !is_sound(c);
      const auto middle = static_cast<double>(result.colours.front().a);
      off_middle += !(middle >= scene.opacity_min && middle <= scene.opacity_max);
    };
    for (const CastRule& rule : rules) {
      wanted.rule = rule;
      wanted.skip = SkipKind::none;
      const CastResult whole = subjects.cast(wanted);
      judge(whole);
      for (const SkipKind kind : structures) {
        // The midpoint rule meets every structure, the others one.
        if (kind != SkipKind::distance_map && rule.integrator != "midpoint-exponential") continue;
        wanted.skip = kind;
        const CastResult leapt = subjects.cast(wanted);
        judge(leapt);
        other_bits += rays_with_other_bits(leapt, whole);
      }
    }
    const std::string of = fmt::format("of {}", runs * static_cast<int>(wanted.rays.size()));
    claims.add(scene.name + ": rays out of bounds or not a number", unsound, exactly(0), of);
    claims.add(scene.name + ": rays that skipping changes", other_bits, exactly(0));
    if (scene.opacity_min > 0 || scene.opacity_max < 1)
      claims.add(scene.name + ": opacity through the middle other than the formula's", off_middle, exactly(0),
                 fmt::format("of {}", runs));
  }
}

}  // namespace brace
