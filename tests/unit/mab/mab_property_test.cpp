// Whatever the levels, the map and the gaze: every pixel is put together from shares of one, and of texels
// that have a ray.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "hmd_sim/gaze.hpp"
#include "runtime/mab/mab_plan.hpp"

namespace brace {
namespace {

class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint32_t seed) : random_(seed) {}
  double unit() { return static_cast<double>(random_()) / 4294967296.0; }
  int below(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }

 private:
  std::mt19937 random_;
};

MabSettings random_settings(RandomNumbers& random, int levels) {
  MabSettings settings;
  settings.levels = levels;
  settings.map = static_cast<LevelMap>(random.below(4));
  settings.anchors.levels = levels;
  settings.anchors.blend = 0.001 + random.unit() * random.unit();
  settings.acuity_slope = random.below(4) == 0 ? 0.0 : random.unit() * 0.2;
  settings.reach = 1 + random.below(2);
  settings.compact = random.below(2) == 0;
  settings.gaze = MabGaze::script;
  double scale = random.below(2) == 0 ? 1.0 : 0.05 + 0.95 * random.unit();
  for (int i = 0; i < levels; ++i) {
    settings.scale[static_cast<std::size_t>(i)] = scale;
    // One in four falls to a level of a single pixel.
    scale *= random.below(4) == 0 ? 0.02 : 0.4 + 0.55 * random.unit();
    settings.anchors.begin[static_cast<std::size_t>(i)] = random.unit();
  }
  std::sort(settings.anchors.begin.begin() + 1, settings.anchors.begin.begin() + levels);
  return settings;
}

sim::DeviceProfile random_headset(RandomNumbers& random) {
  sim::DeviceProfile profile;
  for (sim::EyeProfile& eye : profile.eyes) {
    eye.fov = {-0.5 - random.unit(), 0.5 + random.unit(), -0.5 - random.unit(), 0.5 + random.unit()};
    eye.lens = sim::identity_lens(eye.fov);
    if (random.below(2) == 0) continue;
    eye.lens.kind = sim::LensKind::brown_conrady;
    for (sim::LensChannel& channel : eye.lens.rgb)
      channel.k = {0.3 * random.unit(), 0.2 * random.unit(), 0, 0, 0};
    eye.head_from_eye.orientation = quat_exp({0.0, 0.4 * (random.unit() - 0.5), 0.0});
  }
  return profile;
}

/// Straight ahead, at the corners of the picture, beside it, at its side, behind.
std::vector<glm::dvec3> gazes() {
  std::vector<glm::dvec3> all = {sim::straight_ahead, {1, 0, 0}, {0, 0, 1}, {0, 1, 0.2}};
  for (const double x : {-1.0, 1.0, -3.9})
    for (const double y : {-1.0, 1.0, 3.9})
      all.push_back(sim::direction_of_tangents({x, y}));
  return all;
}

/// Shares of a pixel, as mab.glsl looks them up.
std::vector<float> shares_of(const LevelWeights& weights, float coordinate) {
  const float place = coordinate * 255.0f;
  const auto entry = std::min<std::size_t>(static_cast<std::size_t>(place), 254);
  std::vector<float> shares;
  for (int level = 0; level < weights.levels; ++level) {
    const float* table = weights.entries.data() + level * mab_weight_entries;
    shares.push_back(table[entry] + (place - static_cast<float>(entry)) * (table[entry + 1] - table[entry]));
  }
  return shares;
}

/// Texels of a pixel that have no ray, of those that its reconstruction weighs.
int texels_without_ray(const AtlasRect& level, std::size_t first, glm::ivec2 picture, glm::ivec2 pixel,
                       int reach, const MabRays& rays) {
  const glm::vec2 scale(static_cast<float>(level.width) / static_cast<float>(picture.x),
                        static_cast<float>(level.height) / static_cast<float>(picture.y));
  const glm::vec2 place = (glm::vec2(pixel) + 0.5f) * scale - 0.5f;
  const glm::ivec2 low(static_cast<int>(std::floor(place.x)), static_cast<int>(std::floor(place.y)));
  int missing = 0;
  for (int dy = 1 - reach; dy <= reach; ++dy)
    for (int dx = 1 - reach; dx <= reach; ++dx) {
      const bool weightless = reach == 1 && ((dx == 1 && place.x == static_cast<float>(low.x)) ||
                                             (dy == 1 && place.y == static_cast<float>(low.y)));
      if (weightless) continue;
      const auto x = static_cast<std::size_t>(std::clamp(low.x + dx, 0, level.width - 1));
      const auto y = static_cast<std::size_t>(std::clamp(low.y + dy, 0, level.height - 1));
      missing += rays.ray_of_texel[first + y * static_cast<std::size_t>(level.width) + x] == mab_none;
    }
  return missing;
}

void expect_whole_picture(const MabPlan& plan, glm::ivec2 picture, int reach, sim::Eye eye, int step) {
  const LevelWeights weights = plan.weights(eye, step);
  const MabRays rays = plan.make_rays(eye, step);
  ASSERT_LE(rays.texel_of_ray.size(), plan.capacity());
  for (int y = 0; y < picture.y; ++y)
    for (int x = 0; x < picture.x; ++x) {
      const float coordinate = plan.coordinates(eye)[static_cast<std::size_t>(y * picture.x + x)];
      ASSERT_TRUE(coordinate >= 0.0f && coordinate <= 1.0f) << coordinate;
      const std::vector<float> shares = shares_of(weights, coordinate);
      double sum = 0.0;
      std::size_t first = 0;
      for (std::size_t level = 0; level < shares.size(); ++level) {
        const AtlasRect& size = plan.atlas().levels[level];
        ASSERT_GE(shares[level], 0.0f);
        sum += static_cast<double>(shares[level]);
        if (shares[level] > 0.0f) {
          ASSERT_EQ(texels_without_ray(size, first, picture, {x, y}, reach, rays), 0);
        }
        first += static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
      }
      ASSERT_NEAR(sum, 1.0, 1e-6);
    }
}

TEST(MabProperty, EveryPixelHasSharesOfOneAndARayForEachTexelWhereverTheGazeIs) {
  RandomNumbers random(11);
  const std::vector<glm::dvec3> looks = gazes();
  int single_pixel_levels = 0;
  for (int round = 0; round < 64; ++round) {
    const int levels = 1 + round % mab_levels_max;
    const MabSettings settings = random_settings(random, levels);
    const glm::ivec2 picture(9 + random.below(12), 7 + random.below(12));
    MabPlan plan(settings, random_headset(random), {.eye_px = picture, .panel_px = {40, 30}});
    for (const AtlasRect& level : plan.atlas().levels)
      single_pixel_levels += level.width == 1 && level.height == 1;
    for (int i = 0; i < 3; ++i) {
      plan.look_at(looks[static_cast<std::size_t>(round * 3 + i) % looks.size()]);
      for (const int step : {plan.steps(), plan.steps() / 2, random.below(plan.steps()), 0})
        expect_whole_picture(plan, picture, settings.reach, step % 2 == 0 ? sim::Eye::left : sim::Eye::right,
                             step);
      if (HasFatalFailure()) FAIL() << "round " << round << ", gaze " << i;
    }
  }
  EXPECT_GT(single_pixel_levels, 10) << "they are among the cases";
}

sim::DeviceProfile canted_headset(double turn_rad) {
  sim::DeviceProfile profile;
  for (const sim::Eye eye : sim::all_eyes) {
    sim::EyeProfile& optics = profile.eyes[static_cast<std::size_t>(eye)];
    optics.fov = {-1, 1, -1, 1};
    optics.lens = sim::identity_lens(optics.fov);
    optics.head_from_eye.orientation = quat_exp({0.0, eye == sim::Eye::left ? turn_rad : -turn_rad, 0.0});
  }
  return profile;
}

MabSettings following() {
  MabSettings settings;
  settings.scale = {1.0, 0.7, 0.5, 0.3};
  settings.anchors = {4, {0, 0.3, 0.5, 0.7}, 0.05};
  settings.gaze = MabGaze::trace;
  return settings;
}

/// Column and row of the smallest coordinate.
glm::ivec2 finest(const MabPlan& plan, sim::Eye eye, int across) {
  const std::vector<float>& x = plan.coordinates(eye);
  const auto at = static_cast<int>(std::min_element(x.begin(), x.end()) - x.begin());
  return {at % across, at / across};
}

TEST(MabGaze, TheFinestRaysAreWhereTheEyesLookWithDisplaysThatAreCanted) {
  MabPlan plan(following(), canted_headset(0.1), {.eye_px = {200, 200}, .panel_px = {200, 200}});
  const glm::dvec3 gaze = sim::direction_of_angles(0.3, 0.2);  // to the left and up
  EXPECT_TRUE(plan.look_at(gaze));
  for (const sim::Eye eye : sim::all_eyes) {
    // The left display looks 0.1 to the left already: for it the gaze is 0.2 to the left.
    const double yaw = eye == sim::Eye::left ? 0.2 : 0.4;
    const glm::dvec2 tan = sim::gaze_tangents(sim::direction_of_angles(yaw, 0.0));
    EXPECT_NEAR(finest(plan, eye, 200).x, (tan.x + 1.0) * 100.0, 2.0);
    EXPECT_LT(finest(plan, eye, 200).y, 85) << "up";
  }
}

TEST(MabGaze, LessThanAQuarterOfAPixelAndMapsWithoutAGazeChangeNothing) {
  MabPlan plan(following(), canted_headset(0.0), {.eye_px = {200, 200}, .panel_px = {200, 200}});
  EXPECT_FALSE(plan.look_at(sim::straight_ahead)) << "where it looks at first";
  EXPECT_FALSE(plan.look_at(sim::direction_of_tangents({0.0024, 0.0})));
  EXPECT_TRUE(plan.look_at(sim::direction_of_tangents({0.0026, 0.0})));
  for (const auto& [map, gaze] :
       {std::pair{LevelMap::lens, MabGaze::trace}, std::pair{LevelMap::radius, MabGaze::fixed}}) {
    MabSettings settings = following();
    settings.map = map;
    settings.gaze = gaze;
    MabPlan still(settings, canted_headset(0.0), {.eye_px = {200, 200}, .panel_px = {200, 200}});
    EXPECT_FALSE(still.look_at(sim::direction_of_tangents({0.5, 0.5})));
  }
}

TEST(MabGaze, LevelsKeepTheirLengthsWhereverTheGazeIs) {
  MabPlan plan(following(), canted_headset(0.0), {.eye_px = {200, 200}, .panel_px = {200, 200}});
  const std::uint64_t ahead = plan.rays(plan.steps());
  plan.look_at(sim::direction_of_tangents({1.0, 1.0}));
  EXPECT_EQ(plan.coordinates(sim::Eye::left).front(), 1.0f) << "the far corner is as coarse as it gets";
  EXPECT_LT(plan.rays(plan.steps()), ahead) << "a quarter of the fine disc is left";
}

}  // namespace
}  // namespace brace
