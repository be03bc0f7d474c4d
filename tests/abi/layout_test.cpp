#include <gtest/gtest.h>

#include "layout_1_0.h"

extern "C" std::uint32_t abi_c11_frame_size();
extern "C" std::uint32_t abi_c11_negotiate(std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t);
std::uint32_t abi_cxx20_frame_size();

namespace {

constexpr std::uint32_t version(std::uint32_t major, std::uint32_t minor) {
  return BRACE_ABI_VERSION_MAKE(major, minor);
}

TEST(Abi, CAndCxxSeeTheSameStructs) {
  EXPECT_EQ(abi_c11_frame_size(), abi_cxx20_frame_size());
  EXPECT_EQ(abi_c11_frame_size(), sizeof(brace_cast_frame));
}

TEST(Abi, NegotiationTakesTheNewestVersionThatBothKnow) {
  EXPECT_EQ(abi_c11_negotiate(version(1, 0), version(1, 0), version(1, 0), version(1, 0)), version(1, 0));
  EXPECT_EQ(abi_c11_negotiate(version(1, 0), version(1, 4), version(1, 2), version(1, 9)), version(1, 4));
  EXPECT_EQ(abi_c11_negotiate(version(1, 2), version(2, 1), version(1, 0), version(1, 7)), version(1, 7));
}

TEST(Abi, NegotiationWithoutOverlapGivesNone) {
  EXPECT_EQ(abi_c11_negotiate(version(1, 0), version(1, 4), version(2, 0), version(2, 3)), 0u);
  EXPECT_EQ(abi_c11_negotiate(version(3, 0), version(3, 1), version(1, 0), version(2, 9)), 0u);
  EXPECT_EQ(abi_c11_negotiate(version(1, 1), version(1, 1), version(1, 2), version(1, 2)), 0u);
}

}  // namespace
