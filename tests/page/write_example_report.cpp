// Writes report pages with made-up records into a folder, to look at and for page_test.sh:
//   write_example_report PAGE_FOLDER OUT_FOLDER
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "base/error.hpp"
#include "base/image.hpp"
#include "runtime/report/page.hpp"
#include "runtime/sweep/sweep_page.hpp"
#include "tests/unit/report/made_up_run.hpp"

namespace brace {
namespace {

std::vector<EyePicture> write_pictures(const std::filesystem::path& folder, int vsyncs) {
  std::vector<EyePicture> pictures;
  for (const int vsync : {0, vsyncs / 2, vsyncs - 1}) {
    const EyePicture picture{vsync, fmt::format("{:06}_left.png", vsync),
                             fmt::format("{:06}_right.png", vsync)};
    write_png(folder / picture.left_png, made_up_eye(270, 0.01 * vsync));
    write_png(folder / picture.right_png, made_up_eye(270, 0.01 * vsync + 0.3));
    pictures.push_back(picture);
  }
  return pictures;
}

RunSeries series_of(const MadeUpRun& run, const std::string& label, const std::string& warp) {
  RunSeries series;
  series.label = label;
  series.pipeline = {
      {"rays", "rays/full_rate"}, {"cast", "cast/dvr"}, {"stereo", "stereo/two_pass"}, {"warp", warp}};
  series.left_out = {
      {"skip/none", "99 % of the blocks are occupied: look-ups would cost more than they save"}};
  series.records = run.records;
  series.jobs = run.jobs;
  return series;
}

void write_single(const std::filesystem::path& page_folder, const std::filesystem::path& out) {
  const MadeUpRun run = made_up_run({});
  ReportInput input = made_up_input();
  input.series = {series_of(run, "", "warp/quad")};
  input.series[0].pictures = write_pictures(out, 900);
  write_page(out / "single.html", input, page_folder, out);
}

void write_comparison(const std::filesystem::path& page_folder, const std::filesystem::path& out) {
  const MadeUpRun none = made_up_run({.vsyncs = 180, .seed = 2, .cast_ms = 14.0, .dssim_scale = 1.5});
  const MadeUpRun quad = made_up_run({.vsyncs = 180, .seed = 3, .cast_ms = 15.0, .dssim_scale = 0.4});
  ReportInput input = made_up_input();
  input.series = {series_of(none, "warp/none", "warp/none"), series_of(quad, "warp/quad", "warp/quad")};
  for (RunSeries& series : input.series)
    series.pictures = write_pictures(out, 180);
  write_page(out / "comparison.html", input, page_folder, out);
}

void write_long(const std::filesystem::path& page_folder, const std::filesystem::path& out) {
  MadeUpRun run = made_up_run({.vsyncs = 60'000, .seed = 4});
  ReportInput input = made_up_input();
  input.series = {series_of(run, "", "warp/none")};
  write_page(out / "long.html", input, page_folder, out);
}

void write_empty(const std::filesystem::path& page_folder, const std::filesystem::path& out) {
  ReportInput input = made_up_input();
  const MadeUpRun run = made_up_run({.vsyncs = 1});
  input.tables.clear();
  input.facts.clear();
  input.series = {series_of(run, "", "warp/none")};
  input.series[0].left_out.clear();
  write_page(out / "one_vsync.html", input, page_folder, out);
}

void write_sweep(const std::filesystem::path& page_folder, const std::filesystem::path& out) {
  const SweepFile sweep = parse_sweep(
      "session = 'demo.toml'\n[grid]\npipeline.skip = ['none', 'block', 'distance_map']\n"
      "stage.dvr.step_voxels = [0.25, 0.5, 1, 2, 4]\n",
      "made_up.toml");
  std::vector<SweepRow> rows;
  for (std::int64_t point = 1; point <= 15; ++point) {
    const double step = 0.25 * std::pow(2.0, static_cast<double>((point - 1) % 5));
    const double cost = point <= 5 ? 8.0 : point <= 10 ? 3.0 : 1.0;
    SweepRow row{{point, 1, 1}, point == 7 ? "failed" : "done", point == 7 ? "made to fail" : "", {}};
    for (const std::string& name : sweep_figure_names()) {
      std::optional<double> figure = cost / step;
      if (name.rfind("dssim", 0) == 0) figure = step <= 0.25 ? 0.0 : 0.004 * step * step;
      if (name == "samples") figure = 1e6 * cost / step;
      if (row.status != "done") figure.reset();
      row.figures.push_back(figure);
    }
    rows.push_back(row);
  }
  write_sweep_page(out / "sweep.html", sweep, rows, "made up", page_folder);
}

/// A thousand methods: what a sweep over every subset of a pipeline comes to.
void write_many_methods(const std::filesystem::path& page_folder, const std::filesystem::path& out) {
  std::string text = "session = 'demo.toml'\n[grid]\nplan.leave_out = [";
  for (int subset = 0; subset < 34; ++subset)
    text += "'idle,shading,preintegration,subset-" + std::to_string(subset) + "', ";
  text += "]\nscene.size_m = [";
  for (int scene = 1; scene <= 30; ++scene)
    text += std::to_string(0.1 * scene) + ", ";
  text += "]\npipeline.warp = ['none', 'quad']\nstage.dvr.step_voxels = [0.5, 1.0]\n";
  const SweepFile sweep = parse_sweep(text, "many_methods.toml");
  std::vector<SweepRow> rows;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    SweepRow row{{static_cast<std::int64_t>(i + 1), 1, 1}, "done", "", {}};
    const double step = i % 2 == 0 ? 0.5 : 1.0, wave = std::sin(0.7 * static_cast<double>(i / 2));
    const double cost = (6.0 + 5.0 * wave) / step,
                 spread = 1.0 + 0.9 * std::cos(1.3 * static_cast<double>(i / 2));
    for (const std::string& name : sweep_figure_names()) {
      std::optional<double> figure = cost;
      if (name.rfind("dssim", 0) == 0) figure = 0.03 * step * step * spread / (6.5 + 6.0 * wave);
      if (name == "samples") figure = 1e5 * cost;
      row.figures.push_back(figure);
    }
    rows.push_back(row);
  }
  write_sweep_page(out / "many_methods.html", sweep, rows, "made up", page_folder);
}

}  // namespace
}  // namespace brace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: write_example_report PAGE_FOLDER OUT_FOLDER\n");
    return 2;
  }
  try {
    std::filesystem::create_directories(argv[2]);
    brace::write_single(argv[1], argv[2]);
    brace::write_comparison(argv[1], argv[2]);
    brace::write_long(argv[1], argv[2]);
    brace::write_empty(argv[1], argv[2]);
    brace::write_sweep(argv[1], argv[2]);
    brace::write_many_methods(argv[1], argv[2]);
  } catch (const brace::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return static_cast<int>(e.exit_code());
  }
  return 0;
}
