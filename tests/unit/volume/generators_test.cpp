#include "runtime/volume/generators.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/volume/statistics.hpp"
#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

/// The formula at every voxel centre.
std::vector<double> samples_of(const VolumeFormula& formula, const std::array<int, 3>& dims) {
  std::vector<double> samples;
  for (int z = 0; z < dims[2]; ++z)
    for (int y = 0; y < dims[1]; ++y)
      for (int x = 0; x < dims[0]; ++x)
        samples.push_back(formula((x + 0.5) / dims[0], (y + 0.5) / dims[1], (z + 0.5) / dims[2]));
  return samples;
}

TEST(Generators, EveryVoxelIsTheFormulaAtItsCentre) {
  const std::array<int, 3> dims{15, 19, 11};
  for (const GeneratorInfo& generator : generators()) {
    const std::vector<double> samples = samples_of(generator_formula(generator.name), dims);
    EXPECT_GT(*std::ranges::max_element(samples), 0.0) << generator.name;
    for (const VoxelType type : {VoxelType::uint8, VoxelType::int16, VoxelType::uint16, VoxelType::float32}) {
      const GeneratorSpec spec{generator.name, dims, type};
      const std::vector<double> voxels = values_of(load_volume(*open_generator(spec)));
      ASSERT_EQ(voxels.size(), samples.size());
      double worst = 0;
      for (std::size_t i = 0; i < voxels.size(); ++i)
        worst = std::max(worst, std::abs(voxels[i] - full_scale(type) * samples[i]));
      // Half a quantum, plus the last digits in which a row and the formula may differ.
      EXPECT_LE(worst, type == VoxelType::float32 ? 1e-7 : 0.5 + 1e-9) << to_string(spec);
    }
  }
}

TEST(Generators, MarschnerLobbIsThePublishedSignal) {
  // Marschner and Lobb 1994, eq. 1, written out again.
  const auto formula = generator_formula("marschner_lobb");
  using std::numbers::pi;
  for (const auto& [x, y, z] :
       {std::array{0.0, 0.0, 0.0}, {0.3, -0.2, 0.7}, {-0.9, 0.8, -0.4}, {1.0, 1.0, 1.0}}) {
    const double ring = std::cos(2 * pi * 6 * std::cos(pi * std::sqrt(x * x + y * y) / 2));
    const double expected = (1 - std::sin(pi * z / 2) + 0.25 * (1 + ring)) / (2 * (1 + 0.25));
    EXPECT_NEAR(formula((x + 1) / 2, (y + 1) / 2, (z + 1) / 2), expected, 1e-12);
  }
}

TEST(Generators, BoxHasAnEighthAndSlabIsConstant) {
  const auto box = scan(load("generator:solid_box:32"));
  EXPECT_EQ(box.counts[255], 32U * 32U * 32U / 8U);
  EXPECT_EQ(box.counts[0], 32U * 32U * 32U * 7U / 8U);
  const auto slab = scan(load("generator:slab:5x6x7:uint16"));
  EXPECT_EQ(slab.counts[65535], 5U * 6U * 7U);
}

TEST(Generators, ShellsPeakAtTheirRadiiAndAreEmptyBetween) {
  const auto formula = generator_formula("nested_shells");
  EXPECT_EQ(formula(0.5, 0.5, 0.5), 0);
  EXPECT_NEAR(formula(0.5 + 0.12, 0.5, 0.5), 1.0, 1e-12);
  EXPECT_NEAR(formula(0.5, 0.5 - 0.21, 0.5), 0.75, 1e-12);
  EXPECT_NEAR(formula(0.5, 0.5, 0.5 + 0.30), 0.5, 1e-12);
  EXPECT_NEAR(formula(0.5 - 0.39, 0.5, 0.5), 0.25, 1e-12);
  EXPECT_EQ(formula(0.5 + 0.165, 0.5, 0.5), 0);
  EXPECT_EQ(formula(0.01, 0.01, 0.01), 0);
}

TEST(Generators, VesselsAreMostlyEmptyStayInsideAndRepeat) {
  const Volume volume = load("generator:fractal_vessels:96");
  const auto statistics = scan(volume);
  const double filled =
      1 - static_cast<double>(statistics.counts[0]) / static_cast<double>(statistics.voxels);
  EXPECT_GT(filled, 0.004);
  EXPECT_LT(filled, 0.02);
  EXPECT_EQ(volume.voxels, load("generator:fractal_vessels:96").voxels);
  for (int a = 0; a < 96; ++a)
    for (int b = 0; b < 96; ++b)
      ASSERT_EQ(voxel_value(volume, 0, a, b) + voxel_value(volume, 95, a, b) + voxel_value(volume, a, 0, b) +
                    voxel_value(volume, a, 95, b) + voxel_value(volume, a, b, 95),
                0);
}

TEST(Generators, OneVoxelVolumesWork) {
  for (const GeneratorInfo& generator : generators())
    EXPECT_EQ(load("generator:" + generator.name + ":1").voxels.size(), 1U);
}

TEST(Generators, SpecsRoundTripThroughText) {
  const GeneratorSpec spec = parse_generator("generator:slab:7x1x300:int16");
  EXPECT_EQ(spec.name, "slab");
  EXPECT_EQ(spec.dims, (std::array<int, 3>{7, 1, 300}));
  EXPECT_EQ(spec.type, VoxelType::int16);
  EXPECT_EQ(to_string(spec), "generator:slab:7x1x300:int16");
  EXPECT_EQ(to_string(parse_generator("generator:slab:64")), "generator:slab:64x64x64:uint8");
}

TEST(Generators, WrongSpecsSayWhatIsAccepted) {
  EXPECT_THAT(error_of("generator:solidbox:8"), HasSubstr("did you mean 'solid_box'"));
  EXPECT_THAT(error_of("generator:slab"), HasSubstr("generator:NAME:SIZE"));
  EXPECT_THAT(error_of("generator:"), HasSubstr("generator:NAME:SIZE"));
  EXPECT_THAT(error_of("generator:slab:"), HasSubstr("'' is not a size"));
  EXPECT_THAT(error_of("generator:slab:0"), HasSubstr("'0' is not a size"));
  EXPECT_THAT(error_of("generator:slab:-4"), HasSubstr("not a size"));
  EXPECT_THAT(error_of("generator:slab:4x4"), HasSubstr("accepted: SIZE or XxYxZ"));
  EXPECT_THAT(error_of("generator:slab:4x4x4x4"), HasSubstr("accepted: SIZE or XxYxZ"));
  EXPECT_THAT(error_of("generator:slab:99999999999"), HasSubstr("not a size"));
  EXPECT_THAT(error_of("generator:slab:2147483647"), HasSubstr("too many voxels"));
  EXPECT_THAT(error_of("generator:slab:2000"), HasSubstr("too many voxels"));
  EXPECT_THAT(error_of("generator:slab:8:int12"), HasSubstr("accepted: uint8, int16, uint16, float32"));
  EXPECT_THAT(error_of("generator:slab:8:uint8:x"), HasSubstr("generator:NAME:SIZE"));
}

}  // namespace
}  // namespace brace
