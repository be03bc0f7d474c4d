// Values with a grammar of their own, overrides, paths, comparisons.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/session_text.hpp"

namespace brace {
namespace {

using Kind = Session::Output::Selection::Kind;
using test::error_of;
using test::parse;
using test::smallest;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

Session with(const std::string& key, const std::string& value) {
  return parse(smallest, {{key, value}});
}

TEST(SessionSelection, EveryFormIsRead) {
  EXPECT_EQ(with("output.images", "none").output.images.kind, Kind::none);
  EXPECT_EQ(with("output.images", "ends").output.images.kind, Kind::ends);
  const auto every = with("output.images", "every:7").output.images;
  EXPECT_EQ(every.kind, Kind::every);
  EXPECT_EQ(every.every, 7);
  const auto list = with("output.images", "list:9,0,4").output.images;
  EXPECT_EQ(list.kind, Kind::list);
  EXPECT_THAT(list.list, ElementsAre(0, 4, 9));
}

TEST(SessionSelection, EveryBrokenFormIsRefused) {
  for (const char* value :
       {"every", "every:", "every:0", "every:-1", "every:1.5", "every:1x", "every:99999999999999999999",
        "list:", "list:a", "list:1,,2", "list:-1", "list:1 ,2", "none ", "all", "ends:2", ","}) {
    for (const char* key : {"output.images", "output.error"}) {
      EXPECT_THAT(error_of(smallest, {{key, value}}),
                  testing::AllOf(HasSubstr(key), HasSubstr("accepted: every:N, list:A,B,…, ends, none")))
          << value;
    }
  }
}

TEST(SessionPosition, BothFormsAreAccepted) {
  for (const char* value : {"front:1.2", "front:0", "front:-3", "front:1e2", "0,0,0", "-1.5,2,1e-3"}) {
    EXPECT_EQ(with("scene.position", value).scene.position, value);
  }
}

TEST(SessionPosition, EveryBrokenFormIsRefused) {
  for (const char* value : {"front:", "front", "front:x", "front:1,2", "front:1m", "front:nan", "front:1e999",
                            "1", "1,2", "1,2,3,4", "1;2;3", "1,2,", ",1,2", "x,y,z", "1,2,inf", "back:1"}) {
    EXPECT_THAT(error_of(smallest, {{"scene.position", std::string("'").append(value).append("'")}}),
                HasSubstr("front:D or x,y,z in metres"))
        << value;
  }
}

TEST(SessionCost, EveryFormIsReadAndOthersAreRefused) {
  EXPECT_EQ(with("clock.cost", "model:rtx-4090").clock.cost, "model:rtx-4090");
  EXPECT_EQ(with("clock.cost", "measured").clock.cost, "measured");
  EXPECT_EQ(with("clock.cost", "recorded:../run").clock.cost, "recorded:/run");
  EXPECT_EQ(with("clock.cost", "recorded:/a/b").clock.cost, "recorded:/a/b");
  for (const char* value : {"model:", "recorded:", "model", "gtx-1080", "Measured"}) {
    EXPECT_THAT(error_of(smallest, {{"clock.cost", value}}), HasSubstr("model:NAME, measured"));
  }
  EXPECT_THAT(error_of(smallest, {{"clock.cost", "scripted"}}), HasSubstr("[[clock.script]]"));
}

TEST(SessionScript, SegmentsRiseAndHaveEveryNumber) {
  const auto script = [](const std::string& segments) {
    return smallest + "[clock]\ncost = 'scripted'\nscript = [" + segments + "]\n";
  };
  const Session session =
      parse(script("{from_s=0, cast_ms=3, warp_ms=1}, {from_s=1, cast_ms=30, warp_ms=1}"));
  ASSERT_EQ(session.clock.script.size(), 2U);
  EXPECT_EQ(session.clock.script[1].cast_ms, 30.0);
  EXPECT_THAT(error_of(script("{from_s=0, cast_ms=3}")), HasSubstr("warp_ms"));
  EXPECT_THAT(error_of(script("{from_s=0, cast_ms=-3, warp_ms=1}")), HasSubstr("cast_ms"));
  EXPECT_THAT(error_of(script("{from_s=0, cast_ms=nan, warp_ms=1}")), HasSubstr("cast_ms"));
  EXPECT_THAT(error_of(script("{from_s='0', cast_ms=3, warp_ms=1}")), HasSubstr("from_s"));
  EXPECT_THAT(error_of(script("{from_s=0, cast_ms=3, warp_ms=1, casts=2}")),
              HasSubstr("'clock.script.casts'"));
  EXPECT_THAT(error_of(script("{from_s=1, cast_ms=3, warp_ms=1}, {from_s=1, cast_ms=3, warp_ms=1}")),
              HasSubstr("rising from_s"));
  EXPECT_THAT(error_of(script("")), HasSubstr("clock.script"));
}

TEST(SessionNeck, EveryNumberHasARangeAndUnknownKeysAreRefused) {
  const auto neck = [](const std::string& inside) {
    return "[trace]\nneck = {" + inside + "}\n[scene]\nvolume = 'a.nrrd'\n";
  };
  const Session session = parse(neck("motion = 'natural', seed = 7, seconds = 2.5"));
  ASSERT_TRUE(session.trace.neck.has_value());
  EXPECT_EQ(session.trace.neck->seed, 7U);
  EXPECT_EQ(session.trace.neck->seconds, 2.5);
  EXPECT_TRUE(session.trace.file.empty());
  EXPECT_THAT(error_of(neck("")), HasSubstr("trace.neck.motion"));
  EXPECT_THAT(error_of(neck("motion = 3")), HasSubstr("trace.neck.motion"));
  EXPECT_THAT(error_of(neck("motion = 'rotatio'")), HasSubstr("did you mean 'rotation'?"));
  EXPECT_THAT(error_of(neck("motion = 'spin', degree = 3")), HasSubstr("did you mean 'degrees'?"));
  for (const char* bad : {"degrees = 'x'", "degrees = nan", "metres = 1e9", "seconds = 0", "seconds = -1",
                          "seed = -1", "seed = 1.5", "seed = true"}) {
    EXPECT_THAT(error_of(neck(std::string("motion = 'spin', ") + bad)), HasSubstr("'trace.neck.")) << bad;
  }
  EXPECT_THAT(error_of(neck("motion = 'spin'") + "[trace.x]\n"), HasSubstr("unknown key 'trace.x'"));
  EXPECT_THAT(error_of(smallest, {{"trace.neck", "{motion='spin'}"}}), HasSubstr("one of the two"));
}

TEST(SessionScene, UpAndFrontMustBeDifferentAxes) {
  for (const char* axis : {"+z", "-z"}) {
    EXPECT_THAT(error_of(smallest, {{"scene.up", "-z"}, {"scene.front", axis}}), HasSubstr("scene.front"));
  }
}

TEST(SessionOverrides, TomlAndPlainTextAreBothTakenAndTheLastOneHolds) {
  EXPECT_EQ(with("device.profile", "valve-index").device.profile, "valve-index");
  EXPECT_EQ(with("device.profile", "'valve-index'").device.profile, "valve-index");
  EXPECT_EQ(with("device.resolution_scale", "0.5").device.resolution_scale, 0.5);
  EXPECT_EQ(with("device.resolution_scale", "1").device.resolution_scale, 1.0);
  EXPECT_TRUE(with("trace.strict", "true").trace.strict);
  EXPECT_EQ(parse(smallest, {{"run.seed", "1"}, {"run.seed", "2"}}).run.seed, 2U);
  EXPECT_EQ(with("scene.volume", "generator:slab:32").scene.volume, "generator:slab:32");
}

TEST(SessionOverrides, ErrorsNameTheOverrideNotTheFile) {
  EXPECT_THAT(error_of(smallest, {{"scene.size_m", "-1"}}), HasSubstr("--set scene.size_m: "));
  EXPECT_THAT(error_of(smallest, {{"pipeline.warp", "qud"}}),
              testing::AllOf(HasSubstr("--set pipeline.warp"), HasSubstr("did you mean 'quad'?")));
}

TEST(SessionOverrides, KeysWithoutASectionAreRefused) {
  for (const char* key : {"", ".", "..", "scene", "scene.", ".volume", "scene..", "="}) {
    EXPECT_NE(error_of(smallest, {{key, "1"}}), "") << key;
  }
}

TEST(SessionRun, SeedsAreExactBeyondTwoToThe53) {
  EXPECT_EQ(with("run.seed", "9007199254740993").run.seed, 9007199254740993U);
  EXPECT_EQ(with("run.seed", "9223372036854775807").run.seed, 9223372036854775807U);
  EXPECT_THAT(error_of(smallest, {{"run.seed", "-1"}}), HasSubstr("0 to 2^63-1"));
  EXPECT_THAT(error_of(smallest, {{"run.seed", "18446744073709551615"}}), HasSubstr("run.seed"));
}

TEST(SessionPaths, AreTakenFromTheFolderOfTheSession) {
  const Session session = parse(R"([trace]
file = "traces/../walk.csv"
[scene]
volume = "../data/head.nrrd"
transfer_function = "tf/bone.toml"
)");
  EXPECT_EQ(session.trace.file, "/sessions/walk.csv");
  EXPECT_EQ(session.scene.volume, "/data/head.nrrd");
  EXPECT_EQ(session.scene.transfer_function, "/sessions/tf/bone.toml");
  EXPECT_EQ(with("trace.file", "aframe_tracked_90hz").trace.file, "aframe_tracked_90hz");
  EXPECT_EQ(with("scene.transfer_function", "ct-bone").scene.transfer_function, "ct-bone");
  EXPECT_EQ(with("scene.volume", "/a/b.nrrd").scene.volume, "/a/b.nrrd");
}

TEST(SessionCompare, ValuesBecomeOverrides) {
  const Session session = parse(smallest + "[compare]\nkey = 'run.seed'\nvalues = [1, 2.5, 'x', true]\n");
  ASSERT_EQ(session.compare.size(), 4U);
  const char* const labels[] = {"1", "2.5", "x", "true"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(session.compare[i].label, labels[i]);
    EXPECT_THAT(session.compare[i].settings, ElementsAre(std::pair("run.seed", labels[i])));
  }
}

TEST(SessionCompare, CasesSetSeveralKeys) {
  const Session session = parse(smallest + R"([[compare.case]]
label = "near"
set = { "run.seed" = 2, "scene.position" = "front:0.3", "stage.dvr.step_voxels" = 1.0 }
[[compare.case]]
label = "as it is"
)");
  ASSERT_EQ(session.compare.size(), 2U);
  EXPECT_EQ(session.compare[0].label, "near");
  EXPECT_THAT(session.compare[0].settings,
              UnorderedElementsAre(std::pair("run.seed", "2"), std::pair("scene.position", "front:0.3"),
                                   std::pair("stage.dvr.step_voxels", "1.0")));
  EXPECT_TRUE(session.compare[1].settings.empty());
}

TEST(SessionCompare, BrokenComparisonsAreRefused) {
  const auto compare = [](const std::string& text) { return error_of(smallest + "[compare]\n" + text); };
  EXPECT_THAT(compare("key = 'run.seed'\n"), HasSubstr("both 'key' and 'values'"));
  EXPECT_THAT(compare("values = [1, 2]\n"), HasSubstr("both 'key' and 'values'"));
  EXPECT_THAT(compare("key = 'run.seed'\nvalues = [1]\n"), HasSubstr("at least two"));
  EXPECT_THAT(compare("key = 'run.seed'\nvalues = []\n"), HasSubstr("at least two"));
  EXPECT_THAT(compare("key = 'run.seed'\nvalues = [1, 2, 1]\n"), HasSubstr("twice"));
  EXPECT_THAT(compare("key = 'run.seed'\nvalues = ['', 2]\n"), HasSubstr("empty"));
  EXPECT_THAT(compare("key = 'run.seed'\nvalues = 3\n"), HasSubstr("compare.values"));
  EXPECT_THAT(compare("key = 'compare.key'\nvalues = ['a', 'b']\n"), HasSubstr("[compare] itself"));
  EXPECT_THAT(compare("key = 'run.seed'\ncase = [{ label = 'a' }, { label = 'b' }]\n"), HasSubstr("either"));
  EXPECT_THAT(compare("case = [{ label = 'a' }]\n"), HasSubstr("at least two"));
  EXPECT_THAT(compare("case = [{ label = 'a' }, { label = 'a' }]\n"), HasSubstr("twice"));
  EXPECT_THAT(compare("case = [{ label = 'a' }, { set = { } }]\n"), HasSubstr("wants a label"));
  EXPECT_THAT(compare("case = [{ label = 'a' }, { label = 'b', stages = 3 }]\n"),
              HasSubstr("'stages' is none of its keys"));
}

}  // namespace
}  // namespace brace
