#include "runtime/replay/ideal_cache.hpp"

#include <gtest/gtest.h>

namespace brace {
namespace {

std::shared_ptr<const PanelPair> pictures_of(int edge_px) {
  return std::make_shared<const PanelPair>(
      PanelPair{ImageRgba8(edge_px, edge_px), ImageRgba8(edge_px, edge_px)});
}

TEST(IdealCache, KeepsTheFirstThatFitAndTheNewest) {
  const std::uint64_t bytes = 2 * 4 * 4 * sizeof(Rgba8);
  IdealCache cache(2 * bytes);
  const auto a = pictures_of(4), b = pictures_of(4), c = pictures_of(4), d = pictures_of(4);
  cache.keep("a", a);
  cache.keep("a", a);  // once
  cache.keep("b", b);
  cache.keep("c", c);
  EXPECT_EQ(cache.find("a"), a);
  EXPECT_EQ(cache.find("b"), b);
  EXPECT_EQ(cache.find("c"), c) << "too much, but the newest";
  cache.keep("d", d);
  EXPECT_EQ(cache.find("c"), nullptr);
  EXPECT_EQ(cache.find("d"), d);
  EXPECT_EQ(cache.find("a"), a);
}

TEST(IdealCache, WithoutMemoryKnowsTheNewestAlone) {
  IdealCache cache(0);
  EXPECT_EQ(cache.find(""), nullptr);
  const auto a = pictures_of(0), b = pictures_of(8);
  cache.keep("b", b);
  EXPECT_EQ(cache.find("b"), b);
  cache.keep("a", a);
  EXPECT_EQ(cache.find("b"), nullptr);
  EXPECT_EQ(cache.find("a"), a);
}

}  // namespace
}  // namespace brace
