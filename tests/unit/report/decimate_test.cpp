#include "runtime/report/decimate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "runtime/report/base64.hpp"

namespace brace {
namespace {

std::vector<double> counting(std::size_t count) {
  std::vector<double> x(count);
  std::iota(x.begin(), x.end(), 0.0);
  return x;
}

std::vector<double> noise(std::size_t count) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> y(count);
  for (double& v : y)
    v = normal(random);
  return y;
}

TEST(Decimate, ShortCurvesStayAsTheyAreWithoutNaN) {
  const std::vector<double> x = counting(5), y = {1.0, std::nan(""), 3.0, 2.0, std::nan("")};
  const std::vector<CurvePoint> points = decimate(x, y, 10);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[1].x, 2.0);
  EXPECT_EQ(points[1].y, 3.0);
}

TEST(Decimate, EveryPeakOfABucketIsKeptInOrderOfTime) {
  for (const std::size_t count : {101u, 1000u, 12'345u}) {
    const std::vector<double> x = counting(count), y = noise(count);
    const std::vector<CurvePoint> points = decimate(x, y, 100);
    EXPECT_LE(points.size(), 100u);
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end(), [](auto& a, auto& b) { return a.x < b.x; }));
    for (std::size_t b = 0; b < 50; ++b) {
      const auto begin = static_cast<std::ptrdiff_t>(count * b / 50),
                 end = static_cast<std::ptrdiff_t>(count * (b + 1) / 50);
      for (const double wanted : {*std::min_element(y.begin() + begin, y.begin() + end),
                                  *std::max_element(y.begin() + begin, y.begin() + end)}) {
        EXPECT_TRUE(
            std::any_of(points.begin(), points.end(), [&](const CurvePoint& p) { return p.y == wanted; }));
      }
    }
  }
}

TEST(Decimate, EveryPointKeptIsOneOfTheCurve) {
  const std::vector<double> x = counting(5000), y = noise(5000);
  for (const CurvePoint& p : decimate(x, y, 64))
    EXPECT_EQ(y[static_cast<std::size_t>(p.x)], p.y);
}

TEST(Histogram, EveryValueIsInItsBinOrBeyond) {
  std::vector<double> values = noise(10'000);
  values.push_back(1e6);
  values.push_back(std::nan(""));
  const std::vector<std::vector<double>> groups = {values, {0.5}};
  const Histogram h = histogram_of(groups, 40);
  ASSERT_EQ(h.counts.size(), 2u);
  EXPECT_EQ(std::accumulate(h.counts[0].begin(), h.counts[0].end(), std::int64_t{0}) + h.beyond[0], 10'001);
  EXPECT_GE(h.beyond[0], 1);
  EXPECT_LE(h.counts[0].size(), 45u);
  std::vector<std::int64_t> brute(h.counts[0].size());
  std::int64_t beyond = 0;
  const double top = h.from + h.width * static_cast<double>(brute.size());
  for (const double v : values) {
    if (std::isnan(v)) continue;
    if (v >= top) {
      ++beyond;
    } else {
      ++brute[static_cast<std::size_t>((v - h.from) / h.width)];
    }
  }
  for (std::size_t i = 0; i + 1 < brute.size(); ++i)
    EXPECT_EQ(h.counts[0][i], brute[i]) << i;
}

TEST(Histogram, OneValueAndNoValueHaveBinsThatCanBeDrawn) {
  const std::vector<std::vector<double>> one = {{8.4, 8.4}}, none = {{}, {std::nan("")}};
  const Histogram h = histogram_of(one, 40);
  EXPECT_GT(h.width, 0.0);
  EXPECT_EQ(std::accumulate(h.counts[0].begin(), h.counts[0].end(), std::int64_t{0}), 2);
  EXPECT_EQ(histogram_of(none, 40).counts[1].size(), 0u);
}

TEST(Base64, AgreesWithTheVectorsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace brace
