// Files that no one would write by hand: none may crash, and each is refused with what is wrong.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/unit/session/session_text.hpp"

namespace brace {
namespace {

using test::error_of;
using test::session_stages;
using test::smallest;
using testing::HasSubstr;

std::string repeat(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i)
    all += text;
  return all;
}

TEST(SessionAdversarial, EmptyFilesSayWhatIsMissing) {
  for (const char* text : {"", "\n", " \t\r\n", "# only words\n", "\xEF\xBB\xBF"}) {
    EXPECT_THAT(error_of(text), HasSubstr("no head motion")) << text;
  }
}

TEST(SessionAdversarial, WhatIsNotTomlNamesItsLine) {
  for (const char* text :
       {"\n\x01", "\n[", "\n=", "\na", "\n[[device]", "\nx = \"\\q\"", "\nx = 'a", "\n{}", "\n[device]]"}) {
    EXPECT_THAT(error_of(text), HasSubstr("s.toml:2: not valid TOML")) << text;
  }
  EXPECT_THAT(error_of("\n\xff\xfe"), HasSubstr("not valid TOML"));  // before lines are counted
  EXPECT_THAT(error_of("a = 1\n[a]\nb = 1\n"), HasSubstr("s.toml"));
  EXPECT_THAT(error_of(std::string("\0\0\0", 3)), HasSubstr("s.toml"));
}

TEST(SessionAdversarial, SectionsOfEveryOtherKindAreRefused) {
  for (const char* section :
       {"device", "trace", "scene", "clock", "pipeline", "output", "run", "compare", "stage"}) {
    for (const char* value : {"3", "'x'", "[]", "[{}]", "true", "1979-05-27", "nan", "[[]]"}) {
      const std::string text = std::string(section) + " = " + value + "\n";
      EXPECT_THAT(error_of(text), HasSubstr(section)) << text;
    }
    EXPECT_THAT(error_of("[[" + std::string(section) + "]]\n"), HasSubstr("is a section")) << section;
  }
}

TEST(SessionAdversarial, EveryKeyRefusesEveryOtherKindOfValue) {
  for (const SessionKey& key : session_keys()) {
    for (const char* value :
         {"[]", "[[]]", "{}", "{a = {b = []}}", "1979-05-27T07:32:00Z", "07:32:00", "[{}, 1]", "'''\n\n'''",
          "'\\u0000'", "-0.0", "9223372036854775807", "-9223372036854775808", "1e308", "5e-324"}) {
      error_of(smallest, {{key.name, value}});  // an input error or none at all
    }
  }
}

TEST(SessionAdversarial, DeepNestingIsRefused) {
  const int deep = 10000;
  EXPECT_THAT(error_of("a = " + repeat("[", deep) + repeat("]", deep)), HasSubstr("not valid TOML"));
  EXPECT_THAT(error_of("a = " + repeat("{b = ", deep) + "1" + repeat("}", deep)),
              HasSubstr("not valid TOML"));
  EXPECT_NE(error_of("[" + repeat("a.", 2000) + "b]\nx = 1\n"), "");
  EXPECT_NE(error_of("[trace]\nneck = {motion." + repeat("b.", 2000) + "c = 1}\n"), "");
  EXPECT_NE(error_of(smallest, {{"scene." + repeat("a.", 2000) + "b", "1"}}), "");
  EXPECT_NE(error_of(smallest, {{"scene.volume", repeat("[", deep)}, {"scene.shading", "x"}}), "");
}

TEST(SessionAdversarial, HugeNumbersAndWordsAreRefused) {
  EXPECT_THAT(error_of("[run]\nframes = " + repeat("9", 400) + "\n"), HasSubstr("s.toml:2"));
  EXPECT_THAT(error_of("[device]\nresolution_scale = 1e400\n" + smallest), HasSubstr("s.toml"));
  EXPECT_NE(error_of("[device]\nresolution_scale = 0." + repeat("0", 10000) + "1\n" + smallest), "");
  EXPECT_NE(error_of(smallest, {{"device.lens", repeat("profile", 20000)}}), "");
  EXPECT_NE(error_of(smallest, {{"scene." + repeat("size", 500), "1"}}), "");
  EXPECT_NE(error_of(smallest, {{"output.images", "every:" + repeat("1", 400)}}), "");
}

TEST(SessionAdversarial, OverridesCannotWalkThroughArraysOrValues) {
  EXPECT_THAT(error_of(smallest, {{"clock.script[0].cast_ms", "1"}}), HasSubstr("script[0]"));
  EXPECT_THAT(error_of(smallest, {{"scene.volume.x", "1"}}), HasSubstr("'volume' is not a table"));
  EXPECT_THAT(error_of(smallest, {{"clock.script", "[{}]"}, {"clock.script.0.cast_ms", "1"}}),
              HasSubstr("'script' is not a table"));
  EXPECT_THAT(error_of(smallest, {{"trace.neck", "{}"}, {"trace.file", "x"}}), HasSubstr("one of the two"));
  EXPECT_THAT(error_of("[scene]\nvolume = 'a'\n", {{"trace.neck", "{}"}}), HasSubstr("trace.neck.motion"));
  EXPECT_NE(error_of(smallest, {{"[0].a", "1"}}), "");
}

TEST(SessionAdversarial, OverridesThatHoldMoreThanAValueAreRefusedOrPlainText) {
  EXPECT_NE(error_of(smallest, {{"run.seed", "1\n[device]\nprofile = 'x'"}}), "");
  EXPECT_NE(error_of(smallest, {{"run.seed", ""}}), "");
  EXPECT_NE(error_of(smallest, {{"device.lens", "\xff"}}), "");
}

TEST(SessionAdversarial, FilesThatAreNoneAreRefused) {
  const auto error = [](const std::filesystem::path& file) -> std::string {
    try {
      read_session(file, {}, session_stages());
    } catch (const Error& e) {
      EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(error("/nowhere/s.toml"), HasSubstr("/nowhere/s.toml: cannot be opened"));
  EXPECT_THAT(error(testing::TempDir()), HasSubstr("is a folder"));
  EXPECT_THAT(error("/dev/null"), HasSubstr("no head motion"));
  EXPECT_NE(error(""), "");
  EXPECT_NE(error(repeat("x", 5000)), "");
}

}  // namespace
}  // namespace brace
