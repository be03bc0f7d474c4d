#include "hmd_sim/lens.hpp"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "hmd_sim/polynomial.hpp"

namespace brace::sim {
namespace {

using K = std::array<double, 5>;

EyeLens lens_of(LensKind kind, const K& k) {
  EyeLens lens;
  lens.kind = kind;
  for (LensChannel& channel : lens.rgb)
    channel.k = k;
  return lens;
}

TEST(Lens, ModelsFollowTheirFormulas) {
  const double r = 0.7;
  EXPECT_DOUBLE_EQ(lens_scale(LensKind::identity, {}, r), 1.0);
  EXPECT_NEAR(lens_scale(LensKind::brown_conrady, {0.1, 0.2, 0.3}, r),
              1 + 0.1 * std::pow(r, 2) + 0.2 * std::pow(r, 4) + 0.3 * std::pow(r, 6), 1e-15);
  EXPECT_NEAR(lens_scale(LensKind::panotools, {0.6, 0.4, -1.0, 1.0, 0.5}, r),
              0.6 + 0.4 * r - r * r + std::pow(r, 3) + 0.5 * std::pow(r, 4), 1e-15);
  EXPECT_NEAR(lens_scale(LensKind::vive, {-0.2, -0.1, -0.05, 0.01}, r),
              1 / (1 - 0.2 * r * r - 0.1 * std::pow(r, 4) - 0.05 * std::pow(r, 6)) + 0.01, 1e-15);
}

TEST(Lens, DerivativeIsThatOfTheModel) {
  const struct {
    LensKind kind;
    K k;
  } models[] = {{LensKind::identity, {}},
                {LensKind::brown_conrady, {0.1, 0.2, 0.3}},
                {LensKind::panotools, {0.6, 0.4, -1.0, 1.0, 0.5}},
                {LensKind::vive, {-0.2, -0.1, -0.05, 0.01}}};
  for (const auto& model : models) {
    for (const double r : {0.05, 0.3, 0.9}) {
      const double h = 1e-6;
      const double difference =
          (lens_scale(model.kind, model.k, r + h) - lens_scale(model.kind, model.k, r - h)) / (2 * h);
      EXPECT_NEAR(lens_scale_derivative(model.kind, model.k, r), difference, 1e-8);
    }
  }
}

TEST(Lens, FoldOverIsWhereTheMapTurnsBack) {
  // r (1 - r^2): slope 1 - 3 r^2 = 0.
  EXPECT_NEAR(fold_over_radius(LensKind::brown_conrady, {-1.0}, 10.0), 1.0 / std::sqrt(3.0), 1e-14);
  // 1 / (1 - r^2) has its pole at 1 and no fold before it.
  EXPECT_NEAR(fold_over_radius(LensKind::vive, {-1.0}, 10.0), 1.0, 1e-14);
  // 1 / (1 + r^2): r / (1 + r^2) turns back at 1.
  EXPECT_NEAR(fold_over_radius(LensKind::vive, {1.0}, 10.0), 1.0, 1e-14);
  EXPECT_EQ(fold_over_radius(LensKind::panotools, {1.0, 0.1, 0.1, 0.1}, 3.0), 3.0);
  // A dip that barely reaches zero slope between two near roots is found too: slope (r - 1)^2 - 1e-10.
  const double e = 1e-10;
  EXPECT_NEAR(fold_over_radius(LensKind::panotools, {1 - e, -1.0, 1.0 / 3.0}, 5.0), 1.0 - 1e-5, 1e-7);
}

TEST(Lens, HasAnInverseUpToAPole) {
  for (int i = 1; i <= 100; ++i) {
    const K k{-0.05 * i, -0.01 * (i % 7), -0.003 * (i % 5), 0.02};
    const double usable = fold_over_radius(LensKind::vive, k, 10.0);
    ASSERT_GT(lens_forward(LensKind::vive, k, usable), 1e6) << "the pole is there, and not passed";
    for (const double source : {1e-6, 0.5, 1e3}) {
      const auto r = lens_inverse(LensKind::vive, k, source, usable);
      ASSERT_TRUE(r) << i;
      EXPECT_NEAR(lens_forward(LensKind::vive, k, *r) / source, 1.0, 1e-9) << i;
    }
  }
}

TEST(Lens, InverseNeverReturnsAWrongBranch) {
  const K k{-1.0};
  const double fold = fold_over_radius(LensKind::brown_conrady, k, 10.0);
  const double source_max = lens_forward(LensKind::brown_conrady, k, fold);
  EXPECT_FALSE(lens_inverse(LensKind::brown_conrady, k, source_max * 1.0001, fold));
  for (const double fraction : {0.0, 0.2, 0.9, 0.9999}) {
    const auto r = lens_inverse(LensKind::brown_conrady, k, source_max * fraction, fold);
    ASSERT_TRUE(r);
    EXPECT_LE(*r, fold);
    EXPECT_NEAR(lens_forward(LensKind::brown_conrady, k, *r), source_max * fraction, 1e-15);
  }
  EXPECT_FALSE(lens_inverse(LensKind::brown_conrady, k, -0.1, fold));
  EXPECT_FALSE(lens_inverse(LensKind::brown_conrady, k, std::nan(""), fold));
}

TEST(Lens, PanelAndTangentsAgreeWithTheDocumentedSigns) {
  EyeLens lens = lens_of(LensKind::identity, {});
  lens.panel_size_units = {2.0, 2.0};
  lens.tan_per_unit = {1.0, 1.0};
  const auto corner = panel_to_tangents(lens, Channel::green, {0.0, 0.0});  // top left
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->x, -1.0, 1e-15);
  EXPECT_NEAR(corner->y, 1.0, 1e-15);
  const FovTangents fov{-1, 1, -1, 1};
  EXPECT_NEAR(tangents_to_target_uv(fov, {-1.0, 1.0}).y, 0.0, 1e-15);
  EXPECT_NEAR(target_uv_to_tangents(fov, {0.25, 0.75}).y, -0.5, 1e-15);
}

TEST(Lens, IdentityLensShowsThePictureAsItIs) {
  const FovTangents fov{-1.4, 0.9, -1.3, 1.1};
  const EyeLens lens = identity_lens(fov);
  EXPECT_TRUE(lens_is_identity(lens, fov));
  EXPECT_TRUE(lens_channels_equal(lens));
  for (const glm::dvec2 uv : {glm::dvec2(0.1, 0.9), glm::dvec2(0.5, 0.2), glm::dvec2(1.0, 1.0)}) {
    const auto tangents = panel_to_tangents(lens, Channel::red, uv);
    ASSERT_TRUE(tangents);
    EXPECT_LT(glm::length(tangents_to_target_uv(fov, *tangents) - uv), 1e-14);
  }
  const HiddenAreaMask mask = hidden_area_mask(lens, fov, {16, 16}, {16, 16});
  for (const auto hidden : mask.panel.pixels)
    EXPECT_EQ(hidden, 0);
  for (const auto hidden : mask.source.pixels)
    EXPECT_EQ(hidden, 0);
}

TEST(Lens, ALensThatOnlyScalesIsNotIdentity) {
  const FovTangents fov;
  EyeLens lens = identity_lens(fov);
  lens.tan_per_unit *= 1.001;
  EXPECT_FALSE(lens_is_identity(lens, fov));
  lens = identity_lens(fov);
  lens.rgb[2].centre_uv.x += 0.01;
  EXPECT_FALSE(lens_is_identity(lens, fov));
  EXPECT_FALSE(lens_channels_equal(lens));
}

TEST(Polynomial, FirstNonpositiveFindsTheFirstOfManyRoots) {
  // (x - 1)(x - 2)(x - 3) * -1 is positive at 0.
  EXPECT_NEAR(first_nonpositive({6.0, -11.0, 6.0, -1.0}, 10.0), 1.0, 1e-14);
  EXPECT_EQ(first_nonpositive({1.0, 0.0, 1.0}, 4.0), 4.0);
  EXPECT_EQ(first_nonpositive({-1.0, 5.0}, 4.0), 0.0);
}

}  // namespace
}  // namespace brace::sim
