// Replays a session with its head trace and holds the run against a baseline; what became worse is in the
// message.
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

namespace {

struct Outcome {
  int exit_code = -1;  // -1: the program did not end by itself
  std::string text;    // what it said, errors included
};

std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

Outcome brace(const std::string& arguments) {
  Outcome outcome;
  std::FILE* const pipe = ::popen((quoted(BRACE_EXECUTABLE) + " " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> part{};
  while (const std::size_t read = std::fread(part.data(), 1, part.size(), pipe))
    outcome.text.append(part.data(), read);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

TEST(PoseRegression, ReplayIsNotWorseThanTheBaseline) {
  const std::filesystem::path folder = REGRESSION_FOLDER, run = "pose_regression_run";
  std::filesystem::remove_all(run);  // of the test before
  const Outcome replay = brace("run " + quoted(folder / "session.toml") + " --out " + quoted(run));
  ASSERT_EQ(replay.exit_code, 0) << "the session did not run:\n" << replay.text;

  // Exit code 1: worse beyond the tolerance; 2: the runs cannot be compared.
  const Outcome compare = brace(
      "compare " + quoted(folder / "baseline") + " " + quoted(run) +
      " --tolerance mtp_rotation_ms.p99=5% --tolerance mtp_translation_ms.p99=5% --tolerance dssim=0.002");
  ASSERT_NE(compare.exit_code, 2) << "the baseline is not of this session:\n" << compare.text;
  EXPECT_EQ(compare.exit_code, 0) << "worse than the baseline:\n"
                                  << compare.text
                                  << "look: " << std::filesystem::absolute(run / "report.html").string()
                                  << "\nif it is meant to be: copy summary.json and frames.csv from there to "
                                  << (folder / "baseline").string();
}

}  // namespace
