// What is measured of the machine once and kept: the volume's data path, pipeline.cast = "auto".
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using Json = nlohmann::ordered_json;
using test::Outcome;
using test::Workplace;
using testing::HasSubstr;
using testing::StartsWith;

class Measured : public testing::Test {
 protected:
  Outcome brace(const std::vector<std::string>& arguments) {
    return place_.brace(arguments, {{{"XDG_CACHE_HOME", (place_ / "cache").string()}}});
  }
  Outcome try_run(const std::string& out, const std::vector<std::string>& settings) {
    place_.write("s.toml", test::quick_session());
    std::vector<std::string> arguments = {"run", "s.toml", "--out", out};
    for (const std::string& setting : settings)
      arguments.insert(arguments.end(), {"--set", setting});
    return brace(arguments);
  }
  Json run(const std::string& out, const std::vector<std::string>& settings) {
    const Outcome outcome = try_run(out, settings);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(place_.read(out + "/summary.json"));
  }
  static std::string text_of(const Json& facts, const char* name) {
    return facts.contains(name) ? facts[name].get<std::string>() : std::string();
  }
  /// Puts times into the file that a measurement is kept in; false if there is none.
  bool pretend(const std::string& what, const Json& times_ms) {
    for (const auto& entry : std::filesystem::directory_iterator(place_ / "cache/brace/measured")) {
      Json json = Json::parse(std::ifstream(entry.path()));
      if (json["what"] != what) continue;
      json["times_ms"] = times_ms;
      std::ofstream(entry.path(), std::ios::trunc) << json;
      return true;
    }
    return false;
  }

  Workplace place_;
};

TEST_F(Measured, TheRunThatMeasuresAndTheNextOneDifferUnderHostAlone) {
  Json first = run("a", {}), second = run("b", {});
  EXPECT_THAT(text_of(first["host"], "volume path"), testing::Not(HasSubstr("cached")));
  EXPECT_THAT(text_of(second["host"], "volume path"), HasSubstr("cached"));
  first.erase("host"), second.erase("host");
  EXPECT_EQ(first.dump(), second.dump());
  EXPECT_THAT(text_of(first["facts"], "volume path"), HasSubstr("by measurement on"));
}

TEST_F(Measured, APathThatIsAskedForIsNotMeasured) {
  const Json summary = run("a", {"scene.data_path=sampler"});
  EXPECT_EQ(text_of(summary["facts"], "volume path"), "sampler: asked for");
  EXPECT_FALSE(summary["host"].contains("volume path"));
  EXPECT_FALSE(std::filesystem::exists(place_ / "cache/brace/measured"));
}

TEST_F(Measured, AutoCastFollowsTheTimesOnASoftwareDevice) {
  run("first", {"pipeline.cast=auto"});
  if (!pretend("raycaster", {{"dvr", 3.0}, {"native", 1.0}}))
    GTEST_SKIP() << "cast/native or its use is not here";
  const Json native = run("native", {"pipeline.cast=auto", "stage.dvr.step_voxels=0.25"});
  EXPECT_EQ(native["pipeline"]["cast"], "cast/native");
  EXPECT_THAT(text_of(native["facts"], "cast/auto"), HasSubstr("native: the faster one by measurement"));
  EXPECT_THAT(place_.read("native/session.toml"), HasSubstr("step_voxels = 0.25"))
      << "what dvr is told goes for it";
  ASSERT_TRUE(pretend("raycaster", {{"dvr", 1.0}, {"native", 0.95}}));
  EXPECT_EQ(run("dvr", {"pipeline.cast=auto"})["pipeline"]["cast"], "cast/dvr");
}

TEST_F(Measured, AutoCastIsDvrWithTheReasonWhereNativeDoesNotDo) {
  run("first", {"pipeline.cast=auto"});
  pretend("raycaster", {{"dvr", 3.0}, {"native", 1.0}});
  const Json converged =
      run("converged", {"pipeline.cast=auto", "output.ideal=converged", "output.error=every:1"});
  EXPECT_EQ(converged["pipeline"]["cast"], "cast/dvr");
  const Json tolerance = run("tolerance", {"pipeline.cast=auto", "stage.dvr.tolerance=1e-3"});
  EXPECT_EQ(tolerance["pipeline"]["cast"], "cast/dvr");
  EXPECT_THAT(text_of(tolerance["facts"], "cast/auto"), StartsWith("dvr: "));
  for (const char* setting :
       {"pipeline.stereo=layers", "pipeline.warp=volumetric", "pipeline.skip=occlusion"}) {
    const bool works = try_run("native", {"pipeline.cast=native", setting}).exit_code == 0;
    const Json chosen = run("chosen", {"pipeline.cast=auto", setting});
    EXPECT_TRUE(works || chosen["pipeline"]["cast"] == "cast/dvr") << setting;
    EXPECT_THAT(text_of(chosen["facts"], "cast/auto"),
                testing::AnyOf(StartsWith("dvr: "), StartsWith("native: ")));
  }
}

TEST_F(Measured, AFolderInThePlaceOfAMeasurementIsMeasuredAround) {
  run("a", {});
  for (const auto& entry : std::filesystem::directory_iterator(place_ / "cache/brace/measured")) {
    std::filesystem::remove(entry.path());
    std::filesystem::create_directory(entry.path());
  }
  EXPECT_THAT(text_of(run("b", {})["host"], "volume path"), HasSubstr("not kept"));
}

TEST_F(Measured, DoctorShowsWhatIsKeptAndMeasuresAgainWhenAsked) {
  const Outcome first = brace({"doctor"});
  ASSERT_EQ(first.exit_code, 0) << first.out;
  EXPECT_THAT(first.out, testing::AllOf(HasSubstr("data path 0, 8 bit"), HasSubstr("data path 0, 16 bit"),
                                        HasSubstr("data path 0, float"), HasSubstr("brace/measured")));
  EXPECT_THAT(first.out, testing::Not(HasSubstr("cached")));
  EXPECT_THAT(brace({"doctor"}).out, testing::AllOf(testing::ContainsRegex("data path 0, float .*cached"),
                                                    testing::ContainsRegex("raycaster .*cached")));
  EXPECT_THAT(brace({"doctor", "--measure-again"}).out, testing::Not(HasSubstr("cached")));
}

}  // namespace
}  // namespace brace
