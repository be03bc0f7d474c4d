// The resolved session holds every value used, and is itself a session with the same meaning.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/session_text.hpp"

namespace brace {
namespace {

using test::parse;
using test::smallest;
using testing::HasSubstr;

/// Read from elsewhere on purpose: no path in it may still be relative.
Session parse_again(const Session& session) {
  return parse_session(session.resolved_toml, "again.toml", "/elsewhere", {}, test::session_stages());
}

void expect_same_again(const Session& session) {
  const Session again = parse_again(session);
  EXPECT_EQ(again.resolved_toml, session.resolved_toml);
  EXPECT_EQ(again.trace.file, session.trace.file);
  EXPECT_EQ(again.scene.volume, session.scene.volume);
  EXPECT_EQ(again.scene.transfer_function, session.scene.transfer_function);
  EXPECT_EQ(again.scene.size_m, session.scene.size_m);
  EXPECT_EQ(again.clock.cost, session.clock.cost);
  EXPECT_EQ(again.run.frames, session.run.frames);
  EXPECT_EQ(again.run.seed, session.run.seed);
  EXPECT_EQ(again.output.error.list, session.output.error.list);
  for (const auto& [family, chosen] : session.pipeline) {
    EXPECT_EQ(again.pipeline.at(family).stage.id(), chosen.stage.id());
    EXPECT_EQ(again.pipeline.at(family).values, chosen.values);
  }
}

TEST(ResolvedSession, IsTheSameSessionForTheSmallest) {
  expect_same_again(parse(smallest));
}

TEST(ResolvedSession, IsTheSameSessionForEveryKeyGiven) {
  expect_same_again(parse(R"(
[device]
profile = "quest-3"
resolution_scale = 0.1
render_target = "recommended"
lens = "none"
tracker = "ideal"
[trace]
neck = { motion = "natural", degrees = 30.1, metres = 1e-3, seconds = 0.2, seed = 7 }
interpolation = "slerp"
strict = true
loop = true
start_s = 0.1
[scene]
volume = "../a \"quoted\" 'name'\\with\tall.nrrd"
transfer_function = "tf.toml"
shading = "phong"
size_m = 0.30000000000000004
position = "0,1.5,-2e-1"
up = "-z"
front = "+x"
window = 1e3
level = -0.1
table_entries = 512
nan = "empty"
data_path = "packed"
[clock]
queue = "dual"
cost = "scripted"
cost_scale = 3
warp_lead_ms = 2.25
script = [{ from_s = 0, cast_ms = 1.1, warp_ms = 0.1 }, { from_s = 2, cast_ms = 30, warp_ms = 0.1 }]
[pipeline]
warp = "grid"
predict = "none"
[stage."warp/grid"]
cells = 3
far_plane_m = 0.7
smooth = false
order = "flat"
[output]
images = "none"
error = "list:3,1,2"
[run]
frames = 1000000000000
seed = 9223372036854775807
[compare]
key = "run.seed"
values = [1, 2]
)"));
}

TEST(ResolvedSession, HoldsOverridesAndNotWhatTheyReplaced) {
  const Session session = parse(smallest, {{"device.profile", "valve-index"}, {"scene.volume", "x.nrrd"}});
  EXPECT_THAT(session.resolved_toml, HasSubstr("valve-index"));
  EXPECT_THAT(session.resolved_toml, HasSubstr("/sessions/x.nrrd"));
  EXPECT_THAT(session.resolved_toml, testing::Not(HasSubstr("head.nrrd")));
  expect_same_again(session);
}

TEST(ResolvedSession, HoldsEveryParameterOfTheStagesUsed) {
  const Session session = parse(smallest, {{"pipeline.warp", "grid"}, {"stage.grid.cells", "3"}});
  for (const char* parameter : {"cells = 3", "far_plane_m = 10.0", "smooth = true", "order = "}) {
    EXPECT_THAT(session.resolved_toml, HasSubstr(parameter));
  }
  expect_same_again(session);
}

TEST(ResolvedSession, HoldsEveryKeyThatHasADefault) {
  const Session session = parse(smallest);
  for (const SessionKey& key : session_keys()) {
    if (key.fallback[0] == '\0') continue;
    const std::string name = key.name;
    EXPECT_THAT(session.resolved_toml, HasSubstr(name.substr(name.find('.') + 1) + " = "));
  }
}

}  // namespace
}  // namespace brace
