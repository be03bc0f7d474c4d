#include "runtime/report/run_directory.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/report/csv.hpp"
#include "tests/unit/report/made_up_run.hpp"
#include "tests/unit/report/test_folder.hpp"

namespace brace {
namespace {

class RunDirectoryTest : public TestFolder {
 protected:
  // A whole run with `vsyncs` vsyncs at folder_/name.
  void make_run(const std::filesystem::path& name, int vsyncs) {
    RunDirectory run(folder_ / name);
    const MadeUpRun records = made_up_run({.vsyncs = vsyncs});
    ReportInput input = made_up_input();
    input.series.resize(1);
    input.series[0].records = records.records;
    input.series[0].jobs = records.jobs;
    write_run(run, input, BRACE_PAGE_FOLDER);
    run.commit();
  }

  std::size_t rows(const std::filesystem::path& name) {
    return read_frames_csv(folder_ / name / "frames.csv").size();
  }

  std::string refusal(const std::filesystem::path& path) {
    try {
      RunDirectory run(path);
    } catch (const Error& e) {
      EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
      EXPECT_NE(std::string(e.what()).find("--out"), std::string::npos) << e.what();
      return e.what();
    }
    return "no error";
  }
};

TEST_F(RunDirectoryTest, AWholeRunHasAllItsFilesAndNothingBesideIt) {
  make_run("runs/a", 40);
  for (const char* name :
       {"summary.json", "frames.csv", "costs.csv", "timeline.json", "report.html", "session.toml"}) {
    EXPECT_GT(std::filesystem::file_size(folder_ / "runs/a" / name), 0u) << name;
  }
  EXPECT_EQ(entries(folder_ / "runs"), 1u);
  EXPECT_EQ(rows("runs/a"), 40u);
}

TEST_F(RunDirectoryTest, NothingIsThereBeforeTheCommitNorWithoutIt) {
  {
    RunDirectory run(folder_ / "deep/er/run");
    run.write_text("images/a.png", "x");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "deep/er/run"));
  }
  EXPECT_EQ(entries(folder_), 0u);
}

TEST_F(RunDirectoryTest, AFailedRunTakesBackItsFoldersButNotThoseOfOthers) {
  {
    RunDirectory run(folder_ / "runs/a");
    put(folder_ / "runs/notes.txt", "mine");
  }
  EXPECT_EQ(entries(folder_), 1u);
  EXPECT_EQ(entries(folder_ / "runs"), 1u);
}

TEST_F(RunDirectoryTest, AnEarlierRunIsReplacedInOneStepAtTheCommit) {
  make_run("a", 10);
  {
    RunDirectory run(folder_ / "a");
    EXPECT_EQ(rows("a"), 10u);
  }
  EXPECT_EQ(rows("a"), 10u);
  make_run("a", 20);
  EXPECT_EQ(rows("a"), 20u);
  EXPECT_EQ(entries(folder_), 1u);
}

TEST_F(RunDirectoryTest, AnEmptyFolderIsTaken) {
  std::filesystem::create_directory(folder_ / "a");
  make_run("a/", 5);
  EXPECT_EQ(rows("a"), 5u);
}

TEST_F(RunDirectoryTest, AnythingElseIsRefusedUntouched) {
  put(folder_ / "file", "mine");
  EXPECT_NE(refusal(folder_ / "file").find("is no folder"), std::string::npos);
  std::filesystem::create_directory(folder_ / "other");
  put(folder_ / "other/thesis.tex", "mine");
  EXPECT_NE(refusal(folder_ / "other").find("is no run directory"), std::string::npos);
  put(folder_ / "other/summary.json", "{\"format\": \"other\"}");
  EXPECT_NE(refusal(folder_ / "other").find("is no run directory"), std::string::npos);
  make_run("run", 5);
  put(folder_ / "run/notes.txt", "mine");
  EXPECT_NE(refusal(folder_ / "run").find("notes.txt"), std::string::npos);
  EXPECT_EQ(text_of(folder_ / "run/notes.txt"), "mine");
  EXPECT_NE(refusal("").find("empty"), std::string::npos);
}

TEST_F(RunDirectoryTest, AFileInTheWayOfAParentIsBadInput) {
  put(folder_ / "file", "");
  EXPECT_NE(refusal(folder_ / "file/run").find("Not a directory"), std::string::npos);
  EXPECT_EQ(entries(folder_), 1u);
}

TEST_F(RunDirectoryTest, AFileThatAppearedMeanwhileIsNotOverwritten) {
  RunDirectory run(folder_ / "a");
  run.write_text("summary.json", "{}");
  std::filesystem::create_directory(folder_ / "a");
  put(folder_ / "a/new.txt", "mine");
  EXPECT_THROW(run.commit(), Error);
  EXPECT_EQ(text_of(folder_ / "a/new.txt"), "mine");
}

TEST_F(RunDirectoryTest, ALinkToARunStaysALink) {
  make_run("a", 5);
  std::filesystem::create_symlink("a", folder_ / "latest");
  make_run("latest", 7);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "latest"));
  EXPECT_EQ(rows("a"), 7u);
}

TEST_F(RunDirectoryTest, FurtherSeriesHaveFilesOfTheirOwnAndDistinctLabels) {
  const MadeUpRun none = made_up_run({.vsyncs = 10}), quad = made_up_run({.vsyncs = 12});
  ReportInput input = made_up_input();
  input.series.resize(2);
  input.series[0].label = "warp/none";
  input.series[0].records = none.records;
  input.series[1].label = "warp/quad";
  input.series[1].records = quad.records;
  {
    RunDirectory run(folder_ / "a");
    write_run(run, input, BRACE_PAGE_FOLDER);
    run.commit();
  }
  EXPECT_EQ(rows("a"), 10u);
  EXPECT_EQ(read_frames_csv(folder_ / "a/frames-warp_quad.csv").size(), 12u);
  RunDirectory again(folder_ / "a");  // its further files are known as Brace's own
  input.series[1].label = "warp/none";
  EXPECT_THROW(write_run(again, input, BRACE_PAGE_FOLDER), Error);
}

TEST_F(RunDirectoryTest, StreamedRecordsAreNotOverwritten) {
  RunDirectory run(folder_ / "a");
  FrameCsvWriter writer(run.path("frames.csv"));
  for (const FrameRecord& record : made_up_run({.vsyncs = 33}).records)
    writer.append(record);
  writer.close();
  ReportInput input = made_up_input();
  input.series.resize(1);
  write_run(run, input, BRACE_PAGE_FOLDER);
  run.commit();
  EXPECT_EQ(rows("a"), 33u);
}

}  // namespace
}  // namespace brace
