#include "runtime/replay/vsync_selection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace brace {
namespace {

using Kind = Session::Output::Selection::Kind;
using testing::ElementsAre;
using testing::IsEmpty;

/// The vsyncs named of a run whose first picture is at vsync `first`.
std::vector<std::int64_t> named(const Session::Output::Selection& selection, std::int64_t vsyncs,
                                std::int64_t first = 0) {
  VsyncSelection asked(selection, vsyncs);
  std::vector<std::int64_t> all;
  for (std::int64_t k = first; k < vsyncs; ++k) {
    if (asked.names(k)) all.push_back(k);
  }
  return all;
}

TEST(VsyncSelectionOf, NoneNamesNone) {
  EXPECT_THAT(named({Kind::none, 1, {}}, 100), IsEmpty());
  EXPECT_FALSE(VsyncSelection({Kind::none, 1, {}}, 100).any());
}

TEST(VsyncSelectionOf, EveryCountsFromVsyncZero) {
  EXPECT_THAT(named({Kind::every, 4, {}}, 13), ElementsAre(0, 4, 8, 12));
  EXPECT_THAT(named({Kind::every, 4, {}}, 13, 1), ElementsAre(4, 8, 12));
  EXPECT_THAT(named({Kind::every, 1, {}}, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(named({Kind::every, 1000, {}}, 3, 1), IsEmpty());
  EXPECT_TRUE(VsyncSelection({Kind::every, 1, {}}, 3).any());
}

TEST(VsyncSelectionOf, ListNamesWhatLiesInTheRun) {
  EXPECT_THAT(named({Kind::list, 1, {0, 2, 2, 50}}, 10), ElementsAre(0, 2));
  EXPECT_THAT(named({Kind::list, 1, {50}}, 10), IsEmpty());
}

TEST(VsyncSelectionOf, EndsNamesTheFirstWithAPictureTheMiddleAndTheLast) {
  EXPECT_THAT(named({Kind::ends, 1, {}}, 100), ElementsAre(0, 50, 99));
  EXPECT_THAT(named({Kind::ends, 1, {}}, 100, 3), ElementsAre(3, 50, 99));
  EXPECT_THAT(named({Kind::ends, 1, {}}, 100, 60), ElementsAre(60, 99));
  EXPECT_THAT(named({Kind::ends, 1, {}}, 1), ElementsAre(0));
  EXPECT_THAT(named({Kind::ends, 1, {}}, 2), ElementsAre(0, 1));
}

}  // namespace
}  // namespace brace
