// The shipped extreme scenes through the stages of every family, at a tiny size: sound, or refused by name.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/command.hpp"
#include "tests/cli/covering.hpp"

namespace brace {
namespace {

using test::Combination;
using test::Factor;
using test::Outcome;
using test::Workplace;

const std::filesystem::path examples = std::filesystem::path(BRACE_SOURCE_DIR) / "examples/extreme";

std::vector<std::string> scenes() {
  return {"stiff_shell", "delta_tf",   "fog_1e12", "one_voxel",
          "all_empty",   "all_opaque", "needle",   "huge_gradient"};
}

/// Casters and integrators by a name of their own; the settings that make them.
const std::map<std::string, std::vector<std::string>>& casts() {
  static const std::map<std::string, std::vector<std::string>> all = {
      {"cast/dvr", {}},
      {"cast/dvr left", {"stage.dvr.integrator = 'left'"}},
      {"cast/dvr linear-source", {"stage.dvr.integrator = 'linear-source'"}},
      {"cast/dvr pre-integrated", {"stage.dvr.integrator = 'pre-integrated'"}},
      {"cast/dvr integral",
       {"stage.dvr.integrator = 'pre-integrated'", "stage.dvr.preintegration = 'integral'"}},
      {"cast/dvr adaptive", {"stage.dvr.tolerance = 0.001"}},
      {"cast/dvr lod", {"stage.dvr.lod = 'mip-linear'", "stage.dvr.lod_bias = 1.0"}},
      {"cast/dvr adaptive pre-integrated",
       {"stage.dvr.tolerance = 0.001", "stage.dvr.integrator = 'pre-integrated'"}},
      {"cast/native", {}}};
  return all;
}

/// Stages that do not go together, and say so.
bool refused(const std::string& a, const std::string& b) {
  static const std::vector<std::pair<std::string, std::string>> pairs = {
      {"stereo/layers", "warp/volumetric"}, {"stereo/novel_view", "warp/volumetric"},
      {"skip/occlusion", "rays/mab"},       {"skip/occlusion", "cast/native"},
      {"skip/occlusion", "stereo/layers"},  {"skip/occlusion", "stereo/novel_view"},
      {"cast/dvr lod", "stereo/layers"},    {"cast/dvr lod", "stereo/novel_view"}};
  const auto either = [&](const auto& pair) {
    return (pair.first == a && pair.second == b) || (pair.first == b && pair.second == a);
  };
  return std::any_of(pairs.begin(), pairs.end(), either);
}

/// A family of stages each, as `brace list stages` has them, then casts, then scenes.
std::vector<Factor> factors_of(const Workplace& place) {
  std::map<std::string, std::vector<std::string>> families;
  for (const auto& stage : nlohmann::json::parse(place.brace({"list", "stages", "--json"}).out)) {
    const std::string id = stage["name"];
    families[id.substr(0, id.find('/'))].push_back(id);
  }
  std::vector<Factor> factors;
  for (const char* family : {"rays", "skip", "stereo", "warp", "schedule"})
    factors.push_back({family, families[family]});
  factors.push_back({"cast", {}});
  for (const auto& [name, settings] : casts())
    factors.back().values.push_back(name);
  factors.push_back({"scene", scenes()});
  return factors;
}

std::string value_of(const std::vector<Factor>& factors, const Combination& row, const std::string& factor) {
  for (std::size_t f = 0; f < factors.size(); ++f)
    if (factors[f].name == factor) return factors[f].values[row[f]];
  return "";
}

/// The watchdog looks whether every ray's colour is a number within [0, opacity], and that within [0, 1]; it
/// does not look into these.
bool can_be_watched(const std::vector<Factor>& factors, const Combination& row) {
  return value_of(factors, row, "stereo") == "stereo/two_pass" &&
         value_of(factors, row, "schedule") == "schedule/whole_frame";
}

/// A setting a line, TOML.
std::vector<std::string> settings_of(const std::vector<Factor>& factors, const Combination& row) {
  std::vector<std::string> lines;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    const std::string& value = factors[f].values[row[f]];
    if (factors[f].name == "scene") continue;
    const std::size_t slash = value.find('/');
    lines.push_back(fmt::format("pipeline.{} = '{}'", factors[f].name,
                                value.substr(slash + 1, value.find(' ') - slash - 1)));
    if (factors[f].name == "cast")
      lines.insert(lines.end(), casts().at(value).begin(), casts().at(value).end());
  }
  lines.push_back(fmt::format("run.watchdog = '{}'", can_be_watched(factors, row) ? "full" : "off"));
  return lines;
}

std::string name_of(const std::vector<Factor>& factors, const Combination& row) {
  std::string name;
  for (std::size_t f = 0; f < factors.size(); ++f)
    name += (f == 0 ? "" : ", ") + factors[f].values[row[f]];
  return name;
}

/// Scenes that are to meet every combination of stages: none unless the environment names some.
std::vector<std::string> scenes_met_by_all() {
  const char* wanted = std::getenv("BRACE_EXTREMES");
  if (wanted == nullptr) return {};
  if (wanted == std::string("full")) return scenes();
  std::vector<std::string> named;
  std::stringstream list(wanted);
  for (std::string scene; std::getline(list, scene, ',');) {
    EXPECT_THAT(scenes(), testing::Contains(scene)) << "BRACE_EXTREMES: full, or scenes";
    named.push_back(scene);
  }
  return named;
}

/// Runs combinations of one scene as one sweep and looks at what came out.
void expect_sound(const Workplace& place, const std::string& scene, const std::vector<Factor>& factors,
                  const std::vector<Combination>& rows) {
  std::string text = fmt::format(
      "session = '{}'\n[set]\ndevice.resolution_scale = 0.02\noutput.images = 'none'\noutput.error = 'ends'\n"
      "run.frames = 3\n",
      (examples / (scene + ".toml")).string());
  for (const Combination& row : rows) {
    text += "[[point]]\n";
    for (const std::string& line : settings_of(factors, row))
      text += line + "\n";
  }
  place.write(scene + ".toml", text);
  const Outcome sweep = place.brace({"sweep", scene + ".toml", "--out", scene, "--jobs", "2"});
  EXPECT_EQ(sweep.exit_code, 0) << scene << ": " << sweep.out << sweep.err;
  const std::string csv = place.read(scene + "/results.csv");
  const auto vsyncs = test::csv_cells(csv, "vsyncs"), dssim = test::csv_cells(csv, "dssim_max"),
             faults = test::csv_cells(csv, "watchdog_faults"), status = test::csv_cells(csv, "status");
  ASSERT_EQ(vsyncs.size(), rows.size()) << scene;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string name = name_of(factors, rows[i]);
    EXPECT_EQ(status[i], "done") << name;
    EXPECT_EQ(vsyncs[i], "3") << name;
    ASSERT_FALSE(dssim[i].empty()) << name << ": DSSIM is not a number";
    EXPECT_GE(std::stod(dssim[i]), 0.0) << name;
    EXPECT_LE(std::stod(dssim[i]), 1.0) << name;
    EXPECT_EQ(faults[i], can_be_watched(factors, rows[i]) ? "0" : "") << name;
  }
}

/// All combinations of stages on one scene, the casts in turn.
std::vector<Combination> all_of_scene(const std::vector<Factor>& factors, std::size_t scene) {
  const std::vector<Factor> stages(factors.begin(), factors.end() - 2);
  const std::vector<std::string>& names = factors[factors.size() - 2].values;
  std::vector<Combination> rows = test::all_combinations(stages, refused);
  std::size_t cast = 0;
  for (Combination& row : rows) {
    const auto apart = [&] {
      for (std::size_t f = 0; f < stages.size(); ++f)
        if (refused(names[cast], stages[f].values[row[f]])) return true;
      return false;
    };
    do
      cast = (cast + 1) % names.size();
    while (apart());
    row.push_back(cast);
    row.push_back(scene);
  }
  return rows;
}

class ExtremeScene : public testing::TestWithParam<std::string> {};

// Every two stages of different families that go together meet on the extreme scenes, and each meets every
// scene. BRACE_EXTREMES=full: all combinations of stages, the casts in turn (an hour); or so on the scenes
// named, as in BRACE_EXTREMES=needle,all_empty.
TEST_P(ExtremeScene, IsSoundWithItsShareOfAllPairsOfStages) {
  const Workplace place;
  const std::vector<Factor> factors = factors_of(place);
  const std::vector<std::string> names = scenes();
  const auto scene =
      static_cast<std::size_t>(std::find(names.begin(), names.end(), GetParam()) - names.begin());
  std::vector<Combination> rows = test::covering_pairs(factors, refused);
  EXPECT_LE(rows.size(), 90u) << "so that the set stays short";
  std::erase_if(rows, [&](const Combination& row) { return row.back() != scene; });
  ASSERT_GE(rows.size(), casts().size());
  if (const auto all = scenes_met_by_all(); std::find(all.begin(), all.end(), GetParam()) != all.end())
    for (Combination& row : all_of_scene(factors, scene))
      rows.push_back(std::move(row));
  RecordProperty("runs", static_cast<int>(rows.size()));
  expect_sound(place, GetParam(), factors, rows);
}

INSTANTIATE_TEST_SUITE_P(Extremes, ExtremeScene, testing::ValuesIn(scenes()),
                         [](const auto& scene) { return scene.param; });

TEST(Extremes, StagesThatDoNotGoTogetherSayWhich) {
  const Workplace place;
  std::vector<Factor> factors = factors_of(place);
  factors.pop_back();
  std::size_t next_scene = 0;
  const test::ValuePairs pairs = test::value_pairs(factors, refused);
  for (const auto& [a, b] : pairs.apart) {
    const std::string scene = scenes()[next_scene++ % scenes().size()];
    std::vector<std::string> words = {"run",      (examples / (scene + ".toml")).string(),
                                      "--set",    "device.resolution_scale=0.02",
                                      "--frames", "2",
                                      "--out",    "refused"};
    std::vector<std::string> ids;  // "cast/dvr" of "cast/dvr lod"
    for (const std::string& value : {a, b}) {
      ids.push_back(value.substr(0, value.find(' ')));
      const std::string& id = ids.back();
      words.insert(words.end(),
                   {"--set", "pipeline." + id.substr(0, id.find('/')) + "=" + id.substr(id.find('/') + 1)});
      if (const auto cast = casts().find(value); cast != casts().end())
        for (std::string line : cast->second) {
          std::erase_if(line, [](char c) { return c == ' ' || c == '\''; });
          words.insert(words.end(), {"--set", line});
        }
    }
    const Outcome outcome = place.brace(words);
    EXPECT_EQ(outcome.exit_code, 2) << a << " with " << b << ": " << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, testing::AllOf(testing::HasSubstr("brace: "), testing::HasSubstr(ids[0]),
                                            testing::HasSubstr(ids[1]), testing::HasSubstr("accepted: ")));
    EXPECT_FALSE(std::filesystem::exists(place / "refused"));
  }
  EXPECT_EQ(next_scene, 8u);
}

TEST(Extremes, CoveringPairsMeetAllThatGoTogetherAndNoOther) {
  const std::vector<Factor> factors = {
      {"f", {"f0", "f1", "f2"}}, {"g", {"g0", "g1"}}, {"h", {"h0", "h1", "h2", "h3"}}, {"i", {"i0", "i1"}}};
  const test::Excludes excludes = [](const std::string& a, const std::string& b) {
    return (a == "f1" && b == "h2") || (a == "g1" && b == "i1");
  };
  const auto rows = test::covering_pairs(factors, excludes);
  EXPECT_LT(rows.size(), test::all_combinations(factors, excludes).size());
  const auto met = [&](const std::string& a, const std::string& b) {
    return std::any_of(rows.begin(), rows.end(), [&](const Combination& row) {
      const std::string text = name_of(factors, row);
      return text.find(a) != std::string::npos && text.find(b) != std::string::npos;
    });
  };
  const auto pairs = test::value_pairs(factors, excludes);
  EXPECT_EQ(pairs.apart.size(), 2u);
  EXPECT_EQ(pairs.together.size(), 42u);
  for (const auto& [a, b] : pairs.together)
    EXPECT_TRUE(met(a, b)) << a << ", " << b;
  for (const auto& [a, b] : pairs.apart)
    EXPECT_FALSE(met(a, b)) << a << ", " << b;
}

TEST(Extremes, AToleranceIsRefusedWhereNothingCanKeepIt) {
  const Workplace place;
  const auto run = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {
        "run", (examples / "one_voxel.toml").string(), "--frames", "2", "--out", "refused"};
    for (const std::string& setting : settings) {
      arguments.push_back("--set");
      arguments.push_back(setting);
    }
    return place.brace(arguments);
  };
  const Outcome left = run({"stage.dvr.tolerance=0.001", "stage.dvr.integrator=left"});
  EXPECT_EQ(left.exit_code, 2);
  EXPECT_THAT(left.err, testing::HasSubstr("no error estimate"));
  const Outcome steps = run({"stage.dvr.tolerance=0.001", "stage.dvr.step_voxels_min=2"});
  EXPECT_EQ(steps.exit_code, 2);
  EXPECT_THAT(steps.err, testing::HasSubstr("step_voxels_min = 2"));
  EXPECT_FALSE(std::filesystem::exists(place / "refused"));
}

TEST(Verify, CommandListsClaimsAndRefusesUnknownGroups) {
  const Workplace place;
  const Outcome lenses = place.brace({"verify", "lenses", "--json", "--out", "page"});
  EXPECT_EQ(lenses.exit_code, 0) << lenses.out << lenses.err;
  const auto json = nlohmann::json::parse(lenses.out);
  EXPECT_TRUE(json["passed"].get<bool>());
  EXPECT_GE(json["claims"].size(), 5u);
  EXPECT_THAT(place.read("page/report.html"), testing::HasSubstr("Numerical verification"));
  const Outcome unknown = place.brace({"verify", "lense"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, testing::HasSubstr("did you mean 'lenses'"));
}

}  // namespace
}  // namespace brace
