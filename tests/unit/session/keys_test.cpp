// Every key of a session, taken from the list of keys itself: unknown, of the wrong type, out of range, no
// choice of it. A key added to the list is tested without a line here.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/session_text.hpp"

namespace brace {
namespace {

using test::error_of;
using test::parse;
using test::smallest;
using testing::HasSubstr;

std::string wrong_type_for(const std::string& type) {
  if (type == "text") return "3";
  if (type == "table") return "'words'";
  if (type == "tables") return "[1, 2]";
  if (type == "integer") return "1.5";
  return "'words'";
}

/// Two numbers outside "A to B" or below "above A".
std::vector<std::string> out_of_range(const std::string& accepted) {
  if (accepted.find(" to ") != std::string::npos) return {"-1", "99999999999999999999e9"};
  if (accepted.rfind("above", 0) == 0) return {"-1", "0"};
  return {};
}

std::vector<SessionKey> keys_of_type(const std::set<std::string>& types) {
  std::vector<SessionKey> keys;
  for (const SessionKey& key : session_keys()) {
    if (types.contains(key.type)) keys.push_back(key);
  }
  return keys;
}

TEST(SessionKeys, EveryKeyRefusesTheWrongTypeAndNamesItself) {
  for (const SessionKey& key : session_keys()) {
    const std::string message = error_of(smallest, {{key.name, wrong_type_for(key.type)}});
    EXPECT_THAT(message, HasSubstr(key.name));
    EXPECT_THAT(message, HasSubstr("wants a")) << key.name;
  }
}

TEST(SessionKeys, EveryNumberRefusesWhatIsNotFinite) {
  for (const SessionKey& key : keys_of_type({"number"})) {
    for (const char* value : {"nan", "inf", "-inf"}) {
      EXPECT_THAT(error_of(smallest, {{key.name, value}}), HasSubstr(key.name)) << value;
    }
  }
}

TEST(SessionKeys, EveryRangeIsHeldAtBothEndsAndQuoted) {
  int tested = 0;
  for (const SessionKey& key : keys_of_type({"number", "integer"})) {
    for (const std::string& value : out_of_range(key.accepted)) {
      if (std::string(key.type) == "integer" && value != "-1") continue;
      const std::string message = error_of(smallest, {{key.name, value}});
      EXPECT_THAT(message, HasSubstr(key.name)) << value;
      EXPECT_THAT(message, testing::AnyOf(HasSubstr(key.accepted), HasSubstr("above"))) << value;
      ++tested;
    }
  }
  EXPECT_GE(tested, 15);
}

TEST(SessionKeys, EveryChoiceNamesTheNearestAndAllThatAreAccepted) {
  int tested = 0;
  for (const SessionKey& key : keys_of_type({"text"})) {
    const std::string accepted = key.accepted;
    if (accepted.empty() || accepted.find(':') != std::string::npos) continue;
    const std::string first = accepted.substr(0, accepted.find('|'));
    if (first.size() < 3) continue;
    const std::string message = error_of(smallest, {{key.name, first + "x"}});
    EXPECT_THAT(message, HasSubstr("did you mean '" + first + "'?")) << key.name;
    EXPECT_THAT(message, HasSubstr("accepted: ")) << key.name;
    EXPECT_THAT(message, HasSubstr(std::string("--set ") + key.name)) << key.name;
    ++tested;
  }
  EXPECT_GE(tested, 9);
}

TEST(SessionKeys, EveryChoiceThatTheListNamesIsAccepted) {
  for (const SessionKey& key : keys_of_type({"text"})) {
    std::string accepted = key.accepted;
    if (accepted.empty() || accepted.find(':') != std::string::npos) continue;
    Overrides overrides;
    if (std::string(key.name) == "scene.up") overrides.emplace_back("scene.front", "+x");
    if (std::string(key.name) == "scene.front") overrides.emplace_back("scene.up", "+x");
    for (std::size_t begin = 0; begin <= accepted.size();) {
      const std::size_t end = std::min(accepted.find('|', begin), accepted.size());
      std::string value = accepted.substr(begin, end - begin);
      begin = end + 1;
      if (value == "ITEM,…") value = "warp,skip";
      if (!overrides.empty() && value[1] == 'x') continue;
      Overrides with_value = overrides;
      with_value.emplace_back(key.name, value);
      if (value == "wall")
        with_value.insert(with_value.end(),
                          {{"clock.cost", "measured"}, {"output.images", "none"}, {"output.error", "none"}});
      EXPECT_EQ(error_of(smallest, with_value), "");
    }
  }
}

TEST(SessionKeys, EveryMisspeltKeyIsRefusedAndTheNearestNamed) {
  for (const SessionKey& key : session_keys()) {
    const std::string name = key.name;
    const std::string last = name.substr(name.find('.') + 1);
    if (last.size() < 3) continue;
    const std::string message = error_of(smallest, {{name + "q", "1"}});
    EXPECT_THAT(message, HasSubstr("unknown key '" + name + "q'"));
    EXPECT_THAT(message, HasSubstr("did you mean '" + last + "'?"));
  }
}

TEST(SessionKeys, EveryDefaultIsItselfAccepted) {
  for (const SessionKey& key : session_keys()) {
    if (key.fallback[0] == '\0') continue;
    EXPECT_EQ(error_of(smallest, {{key.name, key.fallback}}), "") << key.name;
  }
}

TEST(SessionKeys, EveryKeyHasAHelp) {
  std::set<std::string> names;
  for (const SessionKey& key : session_keys()) {
    EXPECT_TRUE(names.insert(key.name).second) << key.name;
    EXPECT_GT(std::string(key.help).size(), 3U) << key.name;
  }
}

TEST(SessionKeys, UnknownSectionNamesFileLineAndNearest) {
  const std::string message = error_of("[trace]\nfile = 'a.csv'\n[scen]\nvolume = 'x'\n");
  EXPECT_THAT(message, HasSubstr("s.toml:3"));
  EXPECT_THAT(message, HasSubstr("unknown key 'scen' (did you mean 'scene'?)"));
}

TEST(SessionKeys, UnknownKeyNamesItsLine) {
  EXPECT_THAT(error_of(smallest + "shadin = 'none'\n"),
              testing::AllOf(HasSubstr("s.toml:6"), HasSubstr("'scene.shadin' (did you mean 'shading'?)")));
}

TEST(SessionKeys, WhatIsMissingIsNamedWithItsHelp) {
  EXPECT_THAT(error_of("[trace]\nfile = 'a.csv'\n"),
              testing::AllOf(HasSubstr("'scene.volume' is missing"), HasSubstr("generator:NAME:SIZE")));
  EXPECT_THAT(error_of("[scene]\nvolume = 'a.nrrd'\n"), HasSubstr("'trace.file' or 'trace.neck'"));
}

TEST(SessionKeys, AnEmptyTextIsMissing) {
  for (const SessionKey& key : keys_of_type({"text"})) {
    const std::string name = key.name;
    if (name == "compare.key") continue;  // tested with its section
    EXPECT_NE(error_of(smallest, {{name, "''"}}), "") << name;
  }
}

TEST(SessionKeys, DefaultsFillASmallestSession) {
  const Session session = parse(smallest);
  EXPECT_EQ(session.name, "s");
  EXPECT_EQ(session.device.profile, "htc-vive");
  EXPECT_EQ(session.device.resolution_scale, 1.0);
  EXPECT_EQ(session.scene.position, "front:1.2");
  EXPECT_EQ(session.scene.size_m, 0.6);
  EXPECT_EQ(session.clock.cost, "model:gtx-1080");
  EXPECT_EQ(session.pipeline.size(), 8U);
  EXPECT_EQ(session.pipeline.at("warp").stage.id(), "warp/quad");
  EXPECT_EQ(session.output.images.kind, Session::Output::Selection::Kind::ends);
  EXPECT_FALSE(session.run.frames.has_value());
  EXPECT_TRUE(session.compare.empty());
}

}  // namespace
}  // namespace brace
