#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/host/plugin_library.hpp"
#include "runtime/host/stage_registry.hpp"
#include "tests/unit/host/temporary_folder.hpp"

namespace brace {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string manifest(const std::string& name) {
  return "[stage]\nkind='skip'\nname='" + name + "'\nversion='1'\nhelp='h'\n";
}

/// What find says when it fails with `code`.
std::string message_of(const StageRegistry& registry, const std::string& name, ExitCode code) {
  try {
    registry.find("skip", name, "session.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), code);
    return error.what();
  }
  return "found";
}

TEST(LeftOutPlugins, BrokenFilesDoNotTakeTheOthersAlong) {
  const TemporaryFolder folder;
  folder.write("a.so", "not a library");
  folder.write("b/stage.toml", "[stage]\nkind = 'none such'\n");
  folder.write("c/stage.toml", manifest("works"));
  StageRegistry registry;
  const auto files =
      add_working_plugins(registry, {.given = {folder.path()}, .ambient = {}, .installed = {}});
  ASSERT_EQ(files.size(), 3u);
  EXPECT_THAT(files[0].error, HasSubstr("a.so"));
  EXPECT_THAT(files[1].error, HasSubstr("none such"));
  EXPECT_EQ(files[2].error, "");
  EXPECT_THAT(files[2].stages, ElementsAre("skip/works"));
  EXPECT_EQ(registry.find("skip", "works", "session.toml").name, "works");
}

TEST(LeftOutPlugins, WhoAsksForAStageThatIsNotThereHearsWhatWasLeftOut) {
  const TemporaryFolder folder;
  folder.write("a.so", "not a library");
  StageRegistry registry;
  EXPECT_THAT(message_of(registry, "mine", ExitCode::bad_input), Not(HasSubstr("a.so")));
  add_working_plugins(registry, {.given = {folder.path()}, .ambient = {}, .installed = {}});
  EXPECT_THAT(message_of(registry, "mine", ExitCode::device_or_plugin_failed),
              AllOf(HasSubstr("session.toml"), HasSubstr("skip/mine"), HasSubstr("a.so")));
}

TEST(LeftOutPlugins, ContestedNameIsNobodys) {
  const TemporaryFolder folder;
  folder.write("first/stage.toml", manifest("same"));
  folder.write("second/stage.toml", manifest("same"));
  StageRegistry registry;
  const auto files =
      add_working_plugins(registry, {.given = {folder.path()}, .ambient = {}, .installed = {}});
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].error, "");
  EXPECT_THAT(message_of(registry, "same", ExitCode::device_or_plugin_failed),
              AllOf(HasSubstr("first/stage.toml"), HasSubstr("second/stage.toml")));
}

TEST(LeftOutPlugins, OnlyAGivenPlaceMustBeThere) {
  StageRegistry registry;
  const auto files =
      add_working_plugins(registry, {.given = {}, .ambient = {"/nowhere"}, .installed = "/nowhere"});
  ASSERT_EQ(files.size(), 1u);
  EXPECT_THAT(files[0].error, HasSubstr("/nowhere"));
  EXPECT_THROW(add_working_plugins(registry, {.given = {"/nowhere"}, .ambient = {}, .installed = {}}), Error);
}

}  // namespace
}  // namespace brace
