#include <set>
#include <string>

#include <fmt/format.h>

#include "base/error.hpp"
#include "runtime/report/csv.hpp"
#include "runtime/report/page.hpp"
#include "runtime/report/run_directory.hpp"
#include "runtime/report/summary.hpp"
#include "runtime/report/trace_events.hpp"

namespace brace {

namespace {

// "frames.csv" for the first series, "frames-LABEL.csv" for a further one.
std::string csv_name(const char* stem, const ReportInput& input, std::size_t series) {
  if (series == 0) return fmt::format("{}.csv", stem);
  return fmt::format("{}-{}.csv", stem, file_part(input.series[series].label));
}

void require_distinct_labels(const ReportInput& input) {
  BRACE_CHECK(!input.series.empty());
  if (input.series.size() == 1) return;
  std::set<std::string> names;
  for (const RunSeries& series : input.series) {
    if (!series.label.empty() && names.insert(file_part(series.label)).second) continue;
    throw input_error("series '{}' of the run: its label must be neither empty nor that of another series",
                      series.label);
  }
}

template <typename Writer, typename Record>
void write_unless_there(const std::filesystem::path& path, std::span<const Record> records) {
  if (std::filesystem::exists(path)) return;
  Writer writer(path);
  for (const Record& record : records)
    writer.append(record);
  writer.close();
}

}  // namespace

void write_run(RunDirectory& run, const ReportInput& input, const std::filesystem::path& page_folder) {
  require_distinct_labels(input);
  for (std::size_t i = 0; i < input.series.size(); ++i) {
    write_unless_there<FrameCsvWriter>(run.path(csv_name("frames", input, i)), input.series[i].records);
    write_unless_there<CostCsvWriter>(run.path(csv_name("costs", input, i)), input.series[i].jobs);
  }
  run.write_text("summary.json", summary_json(input));
  run.write_text("session.toml", input.session_toml);
  write_trace_events(run.path("timeline.json"), input);
  write_page(run.path("report.html"), input, page_folder, run.path(""));
}

}  // namespace brace
