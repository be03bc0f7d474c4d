#include "runtime/report/csv.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "base/error.hpp"
#include "runtime/timeline/costs_csv.hpp"
#include "tests/unit/report/made_up_run.hpp"
#include "tests/unit/report/test_folder.hpp"

namespace brace {
namespace {

class FramesCsv : public TestFolder {
 protected:
  std::filesystem::path write(std::span<const FrameRecord> records, const char* name = "frames.csv") {
    FrameCsvWriter writer(folder_ / name);
    for (const FrameRecord& record : records)
      writer.append(record);
    writer.close();
    return folder_ / name;
  }

  std::string message_of_reading(const std::string& text) {
    put(folder_ / "bad.csv", text);
    try {
      read_frames_csv(folder_ / "bad.csv");
    } catch (const Error& e) {
      EXPECT_EQ(e.exit_code(), ExitCode::bad_input);
      return e.what();
    }
    return "no error";
  }
};

// Bits, so that NaN equals NaN and -0 differs from 0.
bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const FrameRecord& a, const FrameRecord& b) {
  bool equal =
      a.vsync_index == b.vsync_index && a.vsync_ns == b.vsync_ns && a.displayed_frame == b.displayed_frame &&
      a.missed == b.missed && a.stale_run == b.stale_run && a.render_pose_ns == b.render_pose_ns &&
      a.render_start_ns == b.render_start_ns && a.render_done_ns == b.render_done_ns &&
      a.warp_pose_ns == b.warp_pose_ns && a.warp_start_ns == b.warp_start_ns &&
      a.warp_done_ns == b.warp_done_ns && a.photon_first_row_ns == b.photon_first_row_ns &&
      a.photon_mid_ns == b.photon_mid_ns && a.photon_last_row_ns == b.photon_last_row_ns &&
      a.mtp_rotation_ns == b.mtp_rotation_ns && a.mtp_translation_ns == b.mtp_translation_ns &&
      a.frame_age_ns == b.frame_age_ns && same(a.angular_error_rad, b.angular_error_rad) &&
      same(a.position_error_m, b.position_error_m) && same(a.dssim_left, b.dssim_left) &&
      same(a.dssim_right, b.dssim_right) && a.work == b.work && a.render_target_ns == b.render_target_ns &&
      a.pose_valid == b.pose_valid && same(a.gaze_x, b.gaze_x) && same(a.gaze_y, b.gaze_y) &&
      same(a.gaze_error_rad, b.gaze_error_rad) && same(a.weighted_rmse_left, b.weighted_rmse_left) &&
      same(a.weighted_rmse_right, b.weighted_rmse_right);
  for (std::size_t i = 0; i < 3; ++i) {
    equal = equal && same(a.angular_error_vector_rad[i], b.angular_error_vector_rad[i]);
  }
  return equal;
}

TEST_F(FramesCsv, HeaderHasTheContractsColumnsInItsOrder) {
  const std::string text = text_of(write({}));
  EXPECT_TRUE(text.starts_with(
      "vsync_index,vsync_ns,displayed_frame,missed,stale_run,render_pose_ns,render_start_ns,render_done_ns,"
      "warp_pose_ns,warp_start_ns,warp_done_ns,photon_first_row_ns,photon_mid_ns,photon_last_row_ns,"
      "mtp_rotation_ns,mtp_translation_ns,frame_age_ns,angular_error_rad,position_error_m,dssim_left,dssim_"
      "right,"
      "rays,samples,skip_steps,"))
      << text;
}

TEST_F(FramesCsv, EveryFieldOfEveryRecordReadsBackBitForBit) {
  std::vector<FrameRecord> records = made_up_run({.vsyncs = 200}).records;
  std::mt19937_64 random(7);
  for (FrameRecord& r : records) {
    const double value = std::bit_cast<double>(random());
    if (!std::isnan(value)) r.dssim_left = r.gaze_x = value;
    r.gaze_y = -0.25;
    r.gaze_error_rad = r.weighted_rmse_left = 1.0 / 3.0;
    r.weighted_rmse_right = 0.1;
    r.vsync_ns = static_cast<std::int64_t>(random());
    r.work.rays = random();
    r.work.shading_fetches = random();
    r.work.bytes = random();
    r.work.skip_steps = random();
    r.pose_valid = random() % 2 == 0;
    r.angular_error_vector_rad = {1e-300, -0.0, std::numeric_limits<double>::denorm_min()};
  }
  records[0] = FrameRecord();
  records[1].dssim_right = std::numeric_limits<double>::infinity();
  records[2].dssim_right = -std::numeric_limits<double>::infinity();
  const std::vector<FrameRecord> back = read_frames_csv(write(records));
  ASSERT_EQ(back.size(), records.size());
  for (std::size_t i = 0; i < back.size(); ++i)
    EXPECT_TRUE(same(back[i], records[i])) << "row " << i;
}

TEST_F(FramesCsv, AFreshRecordsRowHasEmptyCellsForWhatIsNotKnown) {
  const FrameRecord fresh;
  const std::string text = text_of(write(std::span(&fresh, 1)));
  EXPECT_EQ(text.substr(text.find('\n') + 1), "0,0,,0,0,,,,,,,,,,,,,,,,,0,0,0,0,0,0,,1,,,,,,,,\n");
}

TEST_F(FramesCsv, EqualRecordsGiveEqualBytes) {
  EXPECT_EQ(text_of(write(made_up_run({}).records, "a.csv")),
            text_of(write(made_up_run({}).records, "b.csv")));
}

TEST_F(FramesCsv, ColumnsInAnotherOrderAndUnknownOnesAreRead) {
  FrameRecord record;
  record.vsync_index = 42;
  const std::string text = text_of(write(std::span(&record, 1)));
  std::string turned;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    turned += "x," + line.substr(line.find(',') + 1) + "," + line.substr(0, line.find(',')) + "\r\n";
  }
  put(folder_ / "turned.csv", turned);
  const std::vector<FrameRecord> back = read_frames_csv(folder_ / "turned.csv");
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].vsync_index, 42);
}

TEST_F(FramesCsv, FilesFromBeforeTheColumnsOfGazeAreRead) {
  FrameRecord record;
  record.vsync_index = 7;
  record.angular_error_vector_rad = {1, 2, 3};
  std::string old;
  std::istringstream lines(text_of(write(std::span(&record, 1))));
  for (std::string line; std::getline(lines, line);) {
    for (int younger = 0; younger < 5; ++younger)
      line.erase(line.rfind(','));
    old += line + "\n";
  }
  ASSERT_EQ(old.find("gaze"), std::string::npos);
  put(folder_ / "old.csv", old);
  const std::vector<FrameRecord> back = read_frames_csv(folder_ / "old.csv");
  ASSERT_EQ(back.size(), 1u);
  EXPECT_TRUE(same(back[0], record));
}

TEST_F(FramesCsv, BadFilesAreNamedWithLineAndColumn) {
  EXPECT_THROW(read_frames_csv(folder_ / "absent.csv"), Error);
  EXPECT_NE(message_of_reading("a,b\n1,2\n").find("bad.csv:1: column 'vsync_index' is missing"),
            std::string::npos);
  const FrameRecord record;
  const std::string good = text_of(write(std::span(&record, 1)));
  const std::string header = good.substr(0, good.find('\n') + 1);
  EXPECT_NE(message_of_reading(good + "1,2,3\n").find("bad.csv:3: the row ends before column 'missed'"),
            std::string::npos);
  std::string row = good.substr(header.size());
  row[0] = 'q';
  EXPECT_NE(message_of_reading(header + row).find("bad.csv:2: column 'vsync_index' has 'q'"),
            std::string::npos);
}

TEST_F(FramesCsv, CostsStreamTheSameBytesAsTheWholeFileAtOnce) {
  const MadeUpRun run = made_up_run({.vsyncs = 50});
  CostCsvWriter writer(folder_ / "costs.csv");
  for (const JobRecord& job : run.jobs)
    writer.append(job);
  writer.close();
  EXPECT_EQ(text_of(folder_ / "costs.csv"), to_costs_csv(run.jobs));
  EXPECT_EQ(read_costs_csv(folder_ / "costs.csv"), run.jobs);
}

TEST(OutputFile, AFullDiskIsADeviceErrorThatSaysWhatToDo) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  try {
    OutputFile file("/dev/full");
    for (int i = 0; i < 100; ++i)
      file.write(std::string(4096, 'x'));
    file.close();
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::device_or_plugin_failed);
    EXPECT_NE(std::string(e.what()).find("free some space"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace brace
