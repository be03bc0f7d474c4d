#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/session_text.hpp"

namespace brace {
namespace {

using test::error_of;
using test::parse;
using test::smallest;
using testing::HasSubstr;

std::string changes(const std::string& entries) {
  return smallest + "[[scene.transfer_change]]\n" + entries;
}

TEST(SessionTransferChanges, NameWhatChangesAndStandInRisingOrder) {
  const Session session =
      parse(changes("at_s = 0.5\ntransfer_function = 'ct-bone'\n[[scene.transfer_change]]\nat_s = 1\nwindow "
                    "= 300\nlevel = -5\n"));
  ASSERT_EQ(session.scene.transfer_changes.size(), 2U);
  const auto& [first, second] =
      std::pair(session.scene.transfer_changes[0], session.scene.transfer_changes[1]);
  EXPECT_EQ(first.at_s, 0.5);
  EXPECT_EQ(first.transfer_function, "ct-bone");
  EXPECT_FALSE(first.window.has_value());
  EXPECT_EQ(second.window, 300.0);
  EXPECT_EQ(second.level, -5.0);
  EXPECT_FALSE(second.transfer_function.has_value());
}

TEST(SessionTransferChanges, EveryBrokenEntryNamesKeyAndWhatIsAccepted) {
  EXPECT_THAT(error_of(changes("window = 3\n")), HasSubstr("at_s"));
  EXPECT_THAT(error_of(changes("at_s = 0\nwindow = 3\n")), HasSubstr("above 0"));
  EXPECT_THAT(error_of(changes("at_s = nan\nwindow = 3\n")), HasSubstr("finite"));
  EXPECT_THAT(error_of(changes("at_s = 'soon'\nwindow = 3\n")), HasSubstr("'at_s'"));
  EXPECT_THAT(error_of(changes("at_s = 1\n")), HasSubstr("changes nothing"));
  EXPECT_THAT(error_of(changes("at_s = 1\nwindow = 0\n")), HasSubstr("above 0"));
  EXPECT_THAT(error_of(changes("at_s = 1\nlevel = inf\n")), HasSubstr("'level'"));
  EXPECT_THAT(error_of(changes("at_s = 1\ntransfer_function = 3\n")), HasSubstr("preset or a file"));
  EXPECT_THAT(error_of(changes("at_s = 1\ntransfer_function = ''\n")), HasSubstr("preset or a file"));
  EXPECT_THAT(error_of(changes("at_s = 1\nleve = 3\n")), HasSubstr("did you mean 'level'?"));
  EXPECT_THAT(error_of(changes("at_s = 1\nlevel = 3\n[[scene.transfer_change]]\nat_s = 1\nlevel = 4\n")),
              HasSubstr("rising at_s"));
}

TEST(SessionTransferChanges, AnAnimationMovesWindowOrLevel) {
  const auto animated = [](const std::string& value) {
    return parse(smallest, {{"scene.transfer_animation", value}});
  };
  const Session session = animated("{level = [40, 400], seconds = 2}");
  ASSERT_TRUE(session.scene.transfer_animation.has_value());
  EXPECT_EQ(session.scene.transfer_animation->level, (std::array<double, 2>{40, 400}));
  EXPECT_EQ(session.scene.transfer_animation->seconds, 2.0);
  const auto wrong = [](const std::string& value) {
    return error_of(smallest, {{"scene.transfer_animation", value}});
  };
  EXPECT_THAT(wrong("{seconds = 2}"), HasSubstr("moves nothing"));
  EXPECT_THAT(wrong("{level = 3}"), HasSubstr("[from, to]"));
  EXPECT_THAT(wrong("{level = [3]}"), HasSubstr("[from, to]"));
  EXPECT_THAT(wrong("{level = [3, nan]}"), HasSubstr("[from, to]"));
  EXPECT_THAT(wrong("{window = [0, 3]}"), HasSubstr("above 0"));
  EXPECT_THAT(wrong("{window = [1, 3], seconds = 0}"), HasSubstr("seconds"));
  EXPECT_THAT(wrong("{windows = [1, 3]}"), HasSubstr("did you mean 'window'?"));
  EXPECT_THAT(error_of(changes("at_s = 1\nlevel = 3\n"), {{"scene.transfer_animation", "{level = [1, 2]}"}}),
              HasSubstr("one of the two"));
}

TEST(SessionTransferChanges, TheResolvedSessionHoldsThemWithAbsolutePaths) {
  const Session session = parse(changes("at_s = 0.5\ntransfer_function = 'tf.toml'\n"));
  const Session again = parse(session.resolved_toml);
  ASSERT_EQ(again.scene.transfer_changes.size(), 1U);
  EXPECT_EQ(again.scene.transfer_changes[0].transfer_function,
            session.scene.transfer_changes[0].transfer_function);
  EXPECT_EQ(again.scene.transfer_changes[0].transfer_function->front(), '/');
  EXPECT_EQ(again.resolved_toml, session.resolved_toml);
}

}  // namespace
}  // namespace brace
