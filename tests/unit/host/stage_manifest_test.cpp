#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/host/stage_registry.hpp"
#include "temporary_folder.hpp"

namespace brace {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string head = "[stage]\nkind = 'cast'\nname = 'mip'\nversion = '1.0.0'\nhelp = 'one line'\n";
const std::string parameter =
    "[[parameter]]\nname = 'gain'\ntype = 'float'\nmin = 0\nmax = 2\ndefault = 1\nunit = 'x'\nhelp = "
    "'brightness'\n";

StageInfo read(const std::string& text) {
  const TemporaryFolder folder;
  return read_stage_manifest(folder.write("stage.toml", text));
}

std::string error_of(const std::string& text) {
  try {
    (void)read(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << text;
  return "";
}

TEST(StageManifest, ReadsEverythingAStageSays) {
  const StageInfo stage = read(head + parameter);
  EXPECT_EQ(stage.id(), "cast/mip");
  EXPECT_EQ(stage.version, "1.0.0");
  EXPECT_EQ(stage.help, "one line");
  ASSERT_EQ(stage.parameters.size(), 1u);
  const StageParameter& gain = stage.parameters[0];
  EXPECT_EQ(gain.name, "gain");
  EXPECT_EQ(gain.unit, "x");
  EXPECT_EQ(gain.help, "brightness");
  EXPECT_EQ(gain.type, ParameterType::floating);
  EXPECT_EQ(gain.minimum, 0.0);
  EXPECT_EQ(gain.maximum, 2.0);
  EXPECT_EQ(gain.default_value, 1.0);
}

TEST(StageManifest, ChoiceAndFlagBecomeNumbers) {
  const StageInfo stage =
      read(head +
           "[[parameter]]\nname='mode'\ntype='choice'\nchoices=['a','b','c']\ndefault='b'\n"
           "[[parameter]]\nname='on'\ntype='bool'\ndefault=true\n");
  EXPECT_EQ(stage.parameters[0].default_value, 1.0);
  EXPECT_EQ(stage.parameters[0].maximum, 2.0);
  EXPECT_EQ(stage.parameters[1].default_value, 1.0);
}

TEST(StageManifest, MissingKeysAreNamed) {
  for (const std::string key : {"kind", "name", "version", "help"}) {
    std::string text = head;
    const std::size_t at = text.find(key + " = ");
    text.erase(at, text.find('\n', at) - at);
    EXPECT_THAT(error_of(text), HasSubstr("'stage." + key + "'")) << key;
  }
  EXPECT_THAT(error_of("x = 1\n"), HasSubstr("x"));
  EXPECT_THAT(error_of(""), HasSubstr("[stage]"));
}

TEST(StageManifest, UnknownKeyNamesLineAndNearestKey) {
  EXPECT_THAT(error_of(head + "sauce = 'a.glsl'\n"),
              AllOf(HasSubstr(":6"), HasSubstr("did you mean 'source'")));
}

TEST(StageManifest, UnknownKindNamesTheNearest) {
  std::string text = head;
  text.replace(text.find("'cast'"), 6, "'casts'");
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("stage.toml:2"), HasSubstr("did you mean 'cast'")));
}

TEST(StageManifest, NamesAreSnakeCase) {
  std::string text = head;
  text.replace(text.find("'mip'"), 5, "'My Cast'");
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("'My Cast'"), HasSubstr("snake_case")));
  text = head + parameter;
  text.replace(text.find("'gain'"), 6, "'2gain'");
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("'2gain'"), HasSubstr("snake_case")));
}

TEST(StageManifest, SourceThatIsNotThereIsNamed) {
  EXPECT_THAT(error_of(head + "source = 'mip.glsl'\n"),
              AllOf(HasSubstr("stage.toml:6"), HasSubstr("mip.glsl")));
}

TEST(StageManifest, BrokenParametersAreRefused) {
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = head + parameter;
    const std::size_t at = text.find(from, head.size());
    EXPECT_NE(at, std::string::npos) << from;
    return error_of(text.replace(at, from.size(), to));
  };
  EXPECT_THAT(with("type = 'float'", "type = 'flaot'"), HasSubstr("did you mean 'float'"));
  EXPECT_THAT(with("default = 1", "default = 3"), AllOf(HasSubstr("gain = 3"), HasSubstr("0 to 2")));
  EXPECT_THAT(with("default = 1", ""), HasSubstr("'default'"));
  EXPECT_THAT(with("min = 0", ""), HasSubstr("'min'"));
  EXPECT_THAT(with("max = 2", "max = nan"), HasSubstr("finite"));
  EXPECT_THAT(with("max = 2", "max = -1"), HasSubstr("out of range"));
  EXPECT_THAT(with("unit = 'x'", "units = 'x'"), HasSubstr("did you mean 'unit'"));
  EXPECT_THAT(with("type = 'float'", "type = 'choice'"), HasSubstr("choices"));
  EXPECT_THAT(
      with("type = 'float'\nmin = 0\nmax = 2\ndefault = 1", "type = 'int'\nmin=0\nmax=3\ndefault=0.5"),
      HasSubstr("whole numbers"));
  EXPECT_THAT(error_of(head + parameter + parameter), HasSubstr("twice"));
  EXPECT_THAT(error_of(head + "[parameter]\nname = 'gain'\n"), HasSubstr("[[parameter]]"));
  EXPECT_THAT(error_of(head + "[[parameter]]\nname='m'\ntype='choice'\nchoices=['a']\ndefault='b'\n"),
              HasSubstr("'b' is not among the choices: a"));
}

TEST(StageManifest, BrokenTomlNamesFileAndLine) {
  EXPECT_THAT(error_of("[stage\nkind = 1\n"), HasSubstr("stage.toml:1"));
}

TEST(StageManifest, WrongTypesAreRefusedByName) {
  std::string text = head;
  text.replace(text.find("'mip'"), 5, "12");
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("'stage.name'"), HasSubstr("wants a text")));
}

}  // namespace
}  // namespace brace
