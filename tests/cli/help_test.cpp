#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::Workplace;
using testing::HasSubstr;

TEST(CliHelp, EveryCommandHasAnExampleThatNamesIt) {
  Workplace place;
  for (const char* command : {"", "run", "sweep", "compare", "verify", "trace", "trace info", "trace convert",
                              "trace generate", "list", "doctor", "bench"}) {
    std::vector<std::string> arguments;
    std::istringstream words(command);
    for (std::string word; words >> word;)
      arguments.push_back(word);
    arguments.push_back("--help");
    const Outcome outcome = place.brace(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("Example:\n  brace " + std::string(command))) << command;
    EXPECT_EQ(outcome.err, "") << command;
  }
}

TEST(CliHelp, TheProgramsOwnHelpListsTheExitCodes) {
  EXPECT_THAT(Workplace().brace({"--help"}).out, HasSubstr("Exit codes: 0 done"));
}

TEST(CliHelp, AnUnknownCommandIsNamedWithThoseThatThereAre) {
  const Outcome outcome = Workplace().brace({"sweeep", "s.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::AllOf(HasSubstr("'sweeep'"), HasSubstr("did you mean 'sweep'"),
                                          HasSubstr("accepted: run, ")));
}

TEST(CliHelp, VersionIsANumber) {
  const Outcome outcome = Workplace().brace({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(CliList, EveryListHasEntriesAndIsJsonOnRequest) {
  Workplace place;
  for (const char* what :
       {"devices", "stages", "generators", "costs", "transfer-functions", "keys", "traces", "plugins"}) {
    const Outcome text = place.brace({"list", what});
    EXPECT_EQ(text.exit_code, 0) << what << text.err;
    EXPECT_NE(text.out, "") << what;
    const Outcome json = place.brace({"list", what, "--json"});
    EXPECT_EQ(json.exit_code, 0) << what;
    EXPECT_THAT(json.out, testing::AnyOf(testing::StartsWith("["), testing::StartsWith("{"))) << what;
  }
}

}  // namespace
}  // namespace brace
