#include "runtime/volume/statistics.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

template <typename T>
Volume volume_of(VoxelType type, const std::vector<T>& values) {
  Volume volume;
  volume.info.dims = {static_cast<int>(values.size()), 1, 1};
  volume.info.type = type;
  volume.voxels.resize(values.size() * sizeof(T));
  std::memcpy(volume.voxels.data(), values.data(), volume.voxels.size());
  return volume;
}

/// Opaque from `low` to `high`, nothing elsewhere.
TransferTable band(double low, double high, const TableLayout& layout) {
  TransferFunction tf;
  tf.source = "band";
  const double flank = 1e-9 * (std::abs(high) + 1);
  tf.points = {
      {low - flank, {1, 1, 1, 0}}, {low, {1, 1, 1, 2}}, {high, {1, 1, 1, 2}}, {high + flank, {1, 1, 1, 0}}};
  return bake(tf, layout);
}

TEST(Statistics, IntegerCountsAreExactForEveryValue) {
  const auto bytes = scan(volume_of<std::uint8_t>(VoxelType::uint8, {3, 3, 7, 255, 3}));
  EXPECT_EQ(bytes.range.min, 3);
  EXPECT_EQ(bytes.range.max, 255);
  EXPECT_EQ(bytes.counts[3], 3U);
  EXPECT_EQ(bytes.counts[7], 1U);
  const auto shorts = scan(volume_of<std::int16_t>(VoxelType::int16, {-32768, 32767, -1, -1}));
  EXPECT_EQ(shorts.range.min, -32768);
  EXPECT_EQ(shorts.range.max, 32767);
  EXPECT_EQ(shorts.counts[32767], 2U);
  EXPECT_EQ(bin_range(VoxelType::int16, 32767).min, -1);
  const auto unsigned_shorts = scan(volume_of<std::uint16_t>(VoxelType::uint16, {9, 65535}));
  EXPECT_EQ(unsigned_shorts.range.min, 9);
  EXPECT_EQ(unsigned_shorts.range.max, 65535);
}

TEST(Statistics, FloatBinsKeepTheOrderAndHoldTheirValues) {
  std::mt19937 random(3);
  std::vector<float> values{-1e30F, -2.5F, -0.0F, 0.0F, 1e-40F, 0.1F, 3.0F, 1e38F};
  for (int i = 0; i < 1000; ++i)
    values.push_back(static_cast<float>(
        std::ldexp(static_cast<double>(random()) - 2147483648.0, static_cast<int>(random() % 60) - 60)));
  const auto statistics = scan(volume_of(VoxelType::float32, values));
  EXPECT_EQ(statistics.range.min, static_cast<double>(-1e30F));
  EXPECT_EQ(statistics.range.max, static_cast<double>(1e38F));
  std::uint64_t counted = 0;
  double last = -std::numeric_limits<double>::infinity();
  for (std::size_t bin = 0; bin < statistics.counts.size(); ++bin) {
    if (statistics.counts[bin] == 0) continue;
    const ValueRange range = bin_range(VoxelType::float32, bin);
    EXPECT_GE(range.min, last);
    last = range.max;
    const auto inside = [&](float v) {
      const double value = static_cast<double>(v);
      return value >= range.min && value <= range.max;
    };
    // -0 and +0 are equal but have bins of their own.
    if (range.min != 0 && range.max != 0) {
      EXPECT_EQ(statistics.counts[bin],
                static_cast<std::uint64_t>(std::count_if(values.begin(), values.end(), inside)));
    }
    counted += statistics.counts[bin];
  }
  EXPECT_EQ(counted, values.size());
}

TEST(Statistics, NonFiniteVoxelsAreCountedApart) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const auto statistics = scan(volume_of<float>(VoxelType::float32, {inf, std::nanf(""), 5, -inf, 4}));
  EXPECT_EQ(statistics.not_finite, 3U);
  EXPECT_EQ(statistics.voxels, 5U);
  EXPECT_EQ(statistics.range.min, 4);
  EXPECT_EQ(statistics.range.max, 5);
  const auto nothing = scan(volume_of<float>(VoxelType::float32, {inf}));
  EXPECT_EQ(nothing.range.min, 0);
  EXPECT_EQ(nothing.range.max, 0);
}

TEST(Statistics, StreamedScanEqualsTheWholeOne) {
  const std::string name = "generator:marschner_lobb:200x200x120:float32";
  const auto source = open_volume(name);
  std::vector<double> fractions;
  const auto streamed = scan(*source, [&](double fraction) { fractions.push_back(fraction); });
  const auto whole = scan(load(name));
  EXPECT_EQ(streamed.counts, whole.counts);
  EXPECT_EQ(streamed.range.min, whole.range.min);
  EXPECT_EQ(streamed.range.max, whole.range.max);
  EXPECT_GT(fractions.size(), 1U);
  EXPECT_EQ(fractions.back(), 1.0);
}

TEST(Statistics, HistogramBinsAddUpAndTheLastIsClosed) {
  std::vector<std::uint8_t> values(256);
  std::iota(values.begin(), values.end(), std::uint8_t{0});
  const auto statistics = scan(volume_of(VoxelType::uint8, values));
  EXPECT_EQ(histogram(statistics, {0, 255}, 5), (std::vector<std::uint64_t>{51, 51, 51, 51, 52}));
  EXPECT_EQ(histogram(statistics, {10, 20}, 1), (std::vector<std::uint64_t>{11}));
}

TEST(Statistics, OccupiedFractionCountsWhatTheFunctionShows) {
  const Volume volume = volume_of<std::uint8_t>(VoxelType::uint8, {0, 10, 20, 30, 40, 50, 60, 70});
  const TableLayout layout = table_layout(VoxelType::uint8, {0, 70});
  EXPECT_EQ(occupied_fraction(volume, band(20, 40, layout)), 3.0 / 8);
  EXPECT_EQ(occupied_fraction(scan(volume), band(20, 40, layout)), 3.0 / 8);
  EXPECT_EQ(occupied_fraction(volume, band(21, 29, layout)), 0) << "no voxel has a value inside";
  EXPECT_EQ(occupied_fraction(scan(volume), band(21, 29, layout)), 0);
  EXPECT_EQ(occupied_fraction(scan(volume), band(0, 255, layout)), 1) << "all opaque";
}

TEST(Statistics, OccupiedFractionOfFloatsIsAnUpperBound) {
  const Volume volume = load("generator:marschner_lobb:24:float32");
  const auto statistics = scan(volume);
  for (const double low : {0.1, 0.33, 0.5, 0.9}) {
    const TransferTable table = band(low, low + 0.05, table_layout(VoxelType::float32, statistics.range));
    const double exact = occupied_fraction(volume, table);
    const double bound = occupied_fraction(statistics, table);
    EXPECT_GE(bound, exact);
    EXPECT_LE(bound, exact + 0.02);
  }
}

TEST(Statistics, ConstantVolumeHasAPointRange) {
  const auto statistics = scan(load("generator:slab:4"));
  EXPECT_EQ(statistics.range.min, 255);
  EXPECT_EQ(statistics.range.max, 255);
}

}  // namespace
}  // namespace brace
