#include "runtime/timeline/costs_csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::array<const char*, 14> columns{
    "job",     "kind", "index",   "submit_ns",  "start_ns",        "end_ns", "preempted_ns",
    "cost_ns", "rays", "samples", "skip_steps", "shading_fetches", "texels", "bytes"};

void append_cell(std::string& text, std::int64_t value) {
  if (value != -1) fmt::format_to(std::back_inserter(text), "{}", value);
  text += ',';
}

struct Place {
  const std::string& file;
  std::size_t line;
};

template <typename Integer>
Integer parse_integer(std::string_view cell, const char* column, const Place& place) {
  Integer value{};
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) {
    throw input_error("{}:{}: column {}: '{}' is not an integer", place.file, place.line, column, cell);
  }
  return value;
}

std::vector<std::string_view> split(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

JobRecord parse_row(const std::vector<std::string_view>& cells, const std::array<std::size_t, 14>& position,
                    const Place& place) {
  const auto cell = [&](std::size_t column) { return cells[position[column]]; };
  const auto time = [&](std::size_t column) {
    return cell(column).empty() ? -1 : parse_integer<std::int64_t>(cell(column), columns[column], place);
  };
  const auto count = [&](std::size_t column) {
    return parse_integer<std::uint64_t>(cell(column), columns[column], place);
  };
  const std::optional<JobKind> kind = job_kind_from(cell(1));
  if (!kind) {
    throw input_error("{}:{}: column kind: '{}'; accepted: cast, warp, update", place.file, place.line,
                      cell(1));
  }
  JobRecord record{.job = time(0),
                   .kind = *kind,
                   .index = time(2),
                   .submit_ns = time(3),
                   .start_ns = time(4),
                   .end_ns = time(5),
                   .preempted_ns = time(6),
                   .cost_ns = time(7),
                   .work = {.rays = count(8),
                            .samples = count(9),
                            .skip_steps = count(10),
                            .shading_fetches = count(11),
                            .texels = count(12),
                            .bytes = count(13)}};
  if (record.cost_ns < 0) throw input_error("{}:{}: column cost_ns: must be >= 0", place.file, place.line);
  return record;
}

}  // namespace

std::string costs_csv_header() {
  return fmt::format("{}\n", fmt::join(columns, ","));
}

void append_costs_csv_row(std::string& text, const JobRecord& record) {
  append_cell(text, record.job);
  fmt::format_to(std::back_inserter(text), "{},", name_of(record.kind));
  for (const std::int64_t value : {record.index, record.submit_ns, record.start_ns, record.end_ns,
                                   record.preempted_ns, record.cost_ns}) {
    append_cell(text, value);
  }
  const WorkCounts& work = record.work;
  fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{}\n", work.rays, work.samples, work.skip_steps,
                 work.shading_fetches, work.texels, work.bytes);
}

std::string to_costs_csv(std::span<const JobRecord> records) {
  std::string text = costs_csv_header();
  for (const JobRecord& record : records)
    append_costs_csv_row(text, record);
  return text;
}

std::vector<JobRecord> read_costs_csv(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::ifstream stream(path);
  if (!stream) throw input_error("{}: cannot open it; a recording is a run directory with costs.csv", file);
  std::string line;
  if (!std::getline(stream, line)) throw input_error("{}: is empty; a header line is expected", file);
  const std::vector<std::string_view> header = split(line);
  std::array<std::size_t, 14> position{};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto found = std::find(header.begin(), header.end(), columns[i]);
    if (found == header.end()) throw input_error("{}:1: column {} is missing", file, columns[i]);
    position[i] = static_cast<std::size_t>(found - header.begin());
  }
  const std::size_t header_cells = header.size();
  std::vector<JobRecord> records;
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    if (line.empty()) continue;
    const std::vector<std::string_view> cells = split(line);
    if (cells.size() != header_cells) {
      throw input_error("{}:{}: {} cells, the header has {}", file, number, cells.size(), header_cells);
    }
    records.push_back(parse_row(cells, position, {file, number}));
  }
  return records;
}

}  // namespace brace
