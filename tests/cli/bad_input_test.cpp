// Everything a user can hand in that is wrong: exit code 2, a message that names it and says what is
// accepted, and nothing left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::quick_session;
using test::Workplace;
using testing::AllOf;
using testing::HasSubstr;

/// Runs s.toml with settings and expects a refusal that says `message`; returns nothing left behind.
void expect_refused(const Workplace& place, const std::vector<std::string>& settings,
                    const testing::Matcher<std::string>& message) {
  const std::vector<std::string> before = place.names();
  std::vector<std::string> arguments = {"run", "s.toml", "--out", "runs/out"};
  for (const std::string& setting : settings)
    arguments.insert(arguments.end(), {"--set", setting});
  const Outcome outcome = place.brace(arguments);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_THAT(outcome.err, message);
  EXPECT_THAT(outcome.err, testing::StartsWith("brace: "));
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(place.names(), before) << "something was left behind";
}

class CliBadInput : public testing::Test {
 protected:
  void SetUp() override { place_.write("s.toml", quick_session()); }
  Workplace place_;
};

std::string nrrd(const std::string& type, const std::string& sizes, const std::string& bytes) {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: " + sizes +
         "\nencoding: raw\nendian: little\n\n" + bytes;
}

std::string with_trace(const std::string& file) {
  std::string session = quick_session();
  const std::size_t neck = session.find("neck =");
  return session.replace(neck, session.find('\n', neck) - neck, "file = '" + file + "'");
}

TEST_F(CliBadInput, MissingFilesAreNamed) {
  const Outcome outcome = place_.brace({"run", "nothing.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nothing.toml"));
  EXPECT_THAT(place_.names(), testing::ElementsAre("s.toml"));
  expect_refused(place_, {"scene.volume=nothing.nrrd"}, HasSubstr("nothing.nrrd"));
  expect_refused(place_, {"scene.transfer_function=nothing.toml"}, HasSubstr("nothing.toml"));
  expect_refused(place_, {"clock.cost=recorded:nothing"},
                 AllOf(HasSubstr("nothing"), HasSubstr("costs.csv")));
  place_.write("s.toml", with_trace("nothing.csv"));
  expect_refused(place_, {}, HasSubstr("nothing.csv"));
}

TEST_F(CliBadInput, UnknownNamesListWhatThereIs) {
  expect_refused(place_, {"device.profil=x"}, HasSubstr("did you mean 'profile'?"));
  expect_refused(place_, {"device.profile=vive"}, HasSubstr("htc-vive"));
  expect_refused(place_, {"pipeline.warp=qaud"}, HasSubstr("did you mean 'quad'?"));
  expect_refused(place_, {"scene.volume=generator:solid_bx:32"}, HasSubstr("solid_box"));
  expect_refused(place_, {"scene.transfer_function=ct-bones"}, HasSubstr("ct-bone"));
  expect_refused(place_, {"clock.cost=model:gtx-1070"}, HasSubstr("gtx-1080"));
  expect_refused(place_, {"scene.volume=generator:solid_box:0"}, HasSubstr("solid_box:0"));
  expect_refused(place_, {"trace.start_s=99"}, HasSubstr("99"));
  expect_refused(place_, {"trace.loop=true", "run.frames=''"}, HasSubstr("run.frames"));
}

TEST_F(CliBadInput, BrokenVolumesSayWhatIsWrong) {
  place_.write("short.nrrd", nrrd("uchar", "32 32 32", std::string(1000, 'x')));
  expect_refused(place_, {"scene.volume=short.nrrd"}, HasSubstr("short.nrrd"));
  place_.write("flat.nrrd",
               "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 8 8\nencoding: raw\n\n" + std::string(64, 'x'));
  expect_refused(place_, {"scene.volume=flat.nrrd"}, AllOf(HasSubstr("flat.nrrd"), HasSubstr("dimension")));
  place_.write("zero.nrrd", nrrd("uchar", "8 0 8", ""));
  expect_refused(place_, {"scene.volume=zero.nrrd"}, HasSubstr("zero.nrrd"));
  place_.write("huge.nrrd", nrrd("uchar", "99999999 99999999 99999999", "x"));
  expect_refused(place_, {"scene.volume=huge.nrrd"}, HasSubstr("huge.nrrd"));
  place_.write("empty.nrrd", "");
  expect_refused(place_, {"scene.volume=empty.nrrd"}, HasSubstr("empty.nrrd"));
  place_.write("words.nii", "these are words");
  expect_refused(place_, {"scene.volume=words.nii"}, HasSubstr("words.nii"));
  expect_refused(place_, {"scene.volume=s.toml"}, HasSubstr("s.toml"));
  expect_refused(place_, {"scene.volume=."}, HasSubstr("brace-cli"));
}

TEST_F(CliBadInput, NaNVoxelsAreRefusedUnlessTheyShallBeEmpty) {
  const std::string nan("\x00\x00\xC0\x7F", 4);
  std::string voxels;
  for (int i = 0; i < 8 * 8 * 8; ++i)
    voxels += i == 77 ? nan : std::string("\x00\x00\x80\x3F", 4);
  place_.write("nan.nrrd", nrrd("float", "8 8 8", voxels));
  expect_refused(place_, {"scene.volume=nan.nrrd"}, AllOf(HasSubstr("nan.nrrd"), HasSubstr("empty")));
  const Outcome outcome = place_.brace(
      {"run", "s.toml", "--out", "out", "--set", "scene.volume=nan.nrrd", "--set", "scene.nan=empty"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(CliBadInput, BrokenTracesNameFileAndLine) {
  const std::string header = "# timestamp tx ty tz qx qy qz qw\n";
  place_.write("one.txt", header + "0.0 0 1.7 0 0 0 0 1\n");
  place_.write("empty.txt", "");
  place_.write(
      "back.txt",
      header + "0.00 0 1.7 0 0 0 0 1\n0.02 0 1.7 0 0 0 0 1\n0.01 0 1.7 0 0 0 0 1\n0.03 0 1.7 0 0 0 0 1\n");
  place_.write(
      "nan.txt",
      header + "0.00 0 1.7 0 0 0 0 1\n0.01 nan 1.7 0 0 0 0 1\n0.02 0 1.7 0 0 0 0 1\n0.03 0 1.7 0 0 0 0 1\n");
  place_.write("words.txt", "once upon a time\n");
  for (const char* name : {"one.txt", "empty.txt", "words.txt"}) {
    place_.write("s.toml", with_trace(name));
    expect_refused(place_, {}, HasSubstr(name));
  }
  for (const char* name : {"back.txt", "nan.txt"}) {
    place_.write("s.toml", with_trace(name));
    expect_refused(place_, {"trace.strict=true"}, HasSubstr(name));
    const Outcome info = place_.brace({"trace", "info", name, "--strict"});
    EXPECT_EQ(info.exit_code, 2);
    EXPECT_THAT(info.err, HasSubstr(name));
    EXPECT_EQ(place_.brace({"trace", "info", name}).exit_code, 0) << name;
    const Outcome repaired = place_.brace({"run", "s.toml", "--out", "repaired", "--frames", "2"});
    EXPECT_EQ(repaired.exit_code, 0) << repaired.err;
    std::filesystem::remove_all(place_ / "repaired");
  }
}

TEST_F(CliBadInput, ADeviceWithoutLensDataSaysHowToRunItAllTheSame) {
  expect_refused(place_, {"device.profile=valve-index"}, AllOf(HasSubstr("valve-index"), HasSubstr("lens")));
  const Outcome outcome =
      place_.brace({"run", "s.toml", "--out", "out", "--set", "device.profile=valve-index", "--set",
                    "device.lens=none", "--frames", "3"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(CliBadInput, BrokenSettingsAreUsageErrors) {
  expect_refused(place_, {"scene"}, HasSubstr("KEY=VALUE"));
  expect_refused(place_, {"=1"}, HasSubstr("section.key"));
  expect_refused(place_, {"scene.volume.x=1"}, HasSubstr("is not a table"));
  expect_refused(place_, {"run.frames=0"}, HasSubstr("run.frames"));
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"nothing"},
                                             {"run"},
                                             {"run", "s.toml", "--nothing"},
                                             {"run", "s.toml", "--frames", "many"},
                                             {"run", "s.toml", "--frames", "-3", "--out", "x"},
                                             {"run", "s.toml", "--seed", "-3"},
                                             {"list", "nothing"},
                                             {"trace"},
                                             {"trace", "info", "nothing.csv"},
                                             {"trace", "generate", "dancing", "x.trace"},
                                             {"trace", "generate", "rotation", "x.trace", "--seconds", "-1"},
                                             {"trace", "generate", "rotation", "x.trace", "--rate", "nan"},
                                             {"trace", "convert", "s.toml", "x.trace"},
                                             {"bench", "nothing"}}) {
    const Outcome outcome = place_.brace(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(arguments) << outcome.err;
    EXPECT_NE(outcome.err, "") << testing::PrintToString(arguments);
  }
  EXPECT_THAT(place_.names(), testing::ElementsAre("s.toml"));
}

TEST_F(CliBadInput, BrokenRecordingsAreRefused) {
  ASSERT_EQ(place_.brace({"run", "s.toml", "--out", "a", "--frames", "4"}).exit_code, 0);
  expect_refused(place_, {"clock.cost=recorded:a"}, HasSubstr("--frames"));  // ten vsyncs out of four
  const std::string costs = place_.read("a/costs.csv");
  place_.write("b/costs.csv", costs.substr(0, costs.size() / 2));
  expect_refused(place_, {"clock.cost=recorded:b"}, HasSubstr("/b"));
  place_.write("b/costs.csv", "");
  expect_refused(place_, {"clock.cost=recorded:b"}, HasSubstr("/b"));
  place_.write("b/costs.csv", "words\n1,2,3\n");
  expect_refused(place_, {"clock.cost=recorded:b"}, HasSubstr("/b"));
}

}  // namespace
}  // namespace brace
