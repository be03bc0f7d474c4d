#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/session_text.hpp"

namespace brace {
namespace {

using test::error_of;
using test::parse;
using test::smallest;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string with_grid = smallest + "[pipeline]\nwarp = 'grid'\n";

std::vector<double> grid_values(const std::string& settings) {
  return parse(with_grid + settings).pipeline.at("warp").values;
}

TEST(SessionStages, ParametersHaveTheirDefaults) {
  EXPECT_THAT(grid_values(""), ElementsAre(16.0, 10.0, 1.0, 1.0));
}

TEST(SessionStages, ParametersAreReadByShortAndLongName) {
  const std::string values = "cells = 8\nfar_plane_m = 2.5\nsmooth = false\norder = 'cubic'\n";
  EXPECT_THAT(grid_values("[stage.grid]\n" + values), ElementsAre(8.0, 2.5, 0.0, 2.0));
  EXPECT_THAT(grid_values("[stage.\"warp/grid\"]\n" + values), ElementsAre(8.0, 2.5, 0.0, 2.0));
  EXPECT_THAT(parse(with_grid, {{"stage.grid.cells", "4"}}).pipeline.at("warp").value("cells"), 4.0);
  EXPECT_THAT(parse(with_grid, {{"stage.warp/grid.cells", "4"}}).pipeline.at("warp").value("cells"), 4.0);
}

TEST(SessionStages, WrongValuesNameParameterStageAndWhatIsAccepted) {
  for (const char* bad :
       {"cells = 0", "cells = 257", "cells = 1.5", "cells = 'x'", "cells = []", "far_plane_m = 'x'",
        "far_plane_m = nan", "far_plane_m = inf", "far_plane_m = 0.4", "far_plane_m = 1e308",
        "far_plane_m = true", "smooth = 'yes'", "smooth = 2", "order = 'cubi'", "order = 1", "order = {}"}) {
    const std::string message = error_of(with_grid + "[stage.grid]\n" + bad + "\n");
    const std::string parameter(bad, std::string(bad).find(' '));
    EXPECT_THAT(message, HasSubstr(parameter)) << bad;
    EXPECT_THAT(message, HasSubstr("warp/grid")) << bad;
    EXPECT_THAT(message, HasSubstr("s.toml:9")) << bad;
  }
  EXPECT_THAT(error_of(with_grid + "[stage.grid]\norder = 'cubi'\n"), HasSubstr("did you mean 'cubic'?"));
  EXPECT_THAT(error_of(with_grid + "[stage.grid]\ncell = 3\n"), HasSubstr("did you mean 'cells'?"));
}

TEST(SessionStages, UnknownStagesNameTheNearest) {
  EXPECT_THAT(error_of(with_grid + "[stage.gird]\ncells = 3\n"), HasSubstr("did you mean 'grid'?"));
  EXPECT_THAT(error_of(smallest + "[pipeline]\nwarp = 'warp/none'\n"), HasSubstr("pipeline.warp"));
  for (const auto& [family, chosen] : parse(smallest).pipeline) {
    const std::string message = error_of(smallest, {{"pipeline." + family, chosen.stage.name + "x"}});
    EXPECT_THAT(message, HasSubstr("--set pipeline." + family));
    EXPECT_THAT(message, HasSubstr("did you mean '" + chosen.stage.name + "'?"));
  }
}

TEST(SessionStages, SettingsOfAStageLeftOutAreAllowedButMustBeItsOwn) {
  EXPECT_EQ(error_of(smallest + "[stage.grid]\ncells = 3\n"), "");
  EXPECT_THAT(error_of(smallest + "[stage]\ngrid = 3\n"), HasSubstr("is a table"));
  EXPECT_THAT(error_of(with_grid + "[stage]\ngrid = 3\n"), HasSubstr("is a table"));
  EXPECT_THAT(error_of(with_grid + "[[stage.grid]]\ncells = 3\n"), HasSubstr("is a table"));
  EXPECT_THAT(error_of(smallest + "[stage.grid]\ncell = 3\n"), HasSubstr("did you mean 'cells'?"));
}

}  // namespace
}  // namespace brace
