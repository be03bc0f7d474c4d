#include "runtime/report/csv.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>
#include <variant>

#include "base/error.hpp"
#include "runtime/timeline/costs_csv.hpp"

namespace brace {

namespace {

// A field of FrameRecord as a column. Time: -1 is no value. Count: always a value.
struct Time {
  std::int64_t FrameRecord::*field;
};
struct Count {
  std::uint64_t WorkCounts::*field;
};
struct Index {
  std::int64_t FrameRecord::*field;  // always a value
};
struct Axis {
  std::size_t index;  // of angular_error_vector_rad
};
struct Column {
  const char* name;
  std::variant<Index, Time, bool FrameRecord::*, std::int32_t FrameRecord::*, double FrameRecord::*, Count,
               Axis>
      field;
};

// The order is a contract; further columns come at the end.
constexpr Column columns[] = {
    {"vsync_index", Index{&FrameRecord::vsync_index}},
    {"vsync_ns", Index{&FrameRecord::vsync_ns}},
    {"displayed_frame", Time{&FrameRecord::displayed_frame}},
    {"missed", &FrameRecord::missed},
    {"stale_run", &FrameRecord::stale_run},
    {"render_pose_ns", Time{&FrameRecord::render_pose_ns}},
    {"render_start_ns", Time{&FrameRecord::render_start_ns}},
    {"render_done_ns", Time{&FrameRecord::render_done_ns}},
    {"warp_pose_ns", Time{&FrameRecord::warp_pose_ns}},
    {"warp_start_ns", Time{&FrameRecord::warp_start_ns}},
    {"warp_done_ns", Time{&FrameRecord::warp_done_ns}},
    {"photon_first_row_ns", Time{&FrameRecord::photon_first_row_ns}},
    {"photon_mid_ns", Time{&FrameRecord::photon_mid_ns}},
    {"photon_last_row_ns", Time{&FrameRecord::photon_last_row_ns}},
    {"mtp_rotation_ns", Time{&FrameRecord::mtp_rotation_ns}},
    {"mtp_translation_ns", Time{&FrameRecord::mtp_translation_ns}},
    {"frame_age_ns", Time{&FrameRecord::frame_age_ns}},
    {"angular_error_rad", &FrameRecord::angular_error_rad},
    {"position_error_m", &FrameRecord::position_error_m},
    {"dssim_left", &FrameRecord::dssim_left},
    {"dssim_right", &FrameRecord::dssim_right},
    {"rays", Count{&WorkCounts::rays}},
    {"samples", Count{&WorkCounts::samples}},
    {"skip_steps", Count{&WorkCounts::skip_steps}},
    {"shading_fetches", Count{&WorkCounts::shading_fetches}},
    {"texels", Count{&WorkCounts::texels}},
    {"bytes", Count{&WorkCounts::bytes}},
    {"render_target_ns", Time{&FrameRecord::render_target_ns}},
    {"pose_valid", &FrameRecord::pose_valid},
    {"angular_error_pitch_rad", Axis{0}},
    {"angular_error_yaw_rad", Axis{1}},
    {"angular_error_roll_rad", Axis{2}},
    {"gaze_x", &FrameRecord::gaze_x},
    {"gaze_y", &FrameRecord::gaze_y},
    {"gaze_error_rad", &FrameRecord::gaze_error_rad},
    {"weighted_rmse_left", &FrameRecord::weighted_rmse_left},
    {"weighted_rmse_right", &FrameRecord::weighted_rmse_right},
};

// The last of them are younger than files that are still read: without one its figure is that of a run
// without it.
constexpr std::size_t columns_required = 32;
constexpr std::size_t no_column = static_cast<std::size_t>(-1);

template <typename Number>
void append_number(std::string& row, Number value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  row.append(text, end);
}

struct CellWriter {
  const FrameRecord& record;
  std::string& row;

  void operator()(Index c) const { append_number(row, record.*c.field); }
  void operator()(Time c) const {
    if (record.*c.field != -1) append_number(row, record.*c.field);
  }
  void operator()(bool FrameRecord::*field) const { row += record.*field ? '1' : '0'; }
  void operator()(std::int32_t FrameRecord::*field) const { append_number(row, record.*field); }
  void operator()(double FrameRecord::*field) const { real(record.*field); }
  void operator()(Axis c) const { real(record.angular_error_vector_rad[c.index]); }
  void real(double value) const {
    if (!std::isnan(value)) append_number(row, value);
  }
  void operator()(Count c) const { append_number(row, record.work.*c.field); }
};

template <typename Number>
bool parse(std::string_view text, Number& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

// Each returns whether the cell was understood.
struct CellReader {
  FrameRecord& record;
  std::string_view cell;

  bool operator()(Index c) const { return parse(cell, record.*c.field); }
  bool operator()(Time c) const {
    record.*c.field = -1;
    return cell.empty() || parse(cell, record.*c.field);
  }
  bool operator()(bool FrameRecord::*field) const {
    record.*field = cell == "1";
    return cell == "0" || cell == "1";
  }
  bool operator()(std::int32_t FrameRecord::*field) const { return parse(cell, record.*field); }
  bool operator()(double FrameRecord::*field) const { return real(record.*field); }
  bool operator()(Axis c) const { return real(record.angular_error_vector_rad[c.index]); }
  bool real(double& value) const {
    value = std::numeric_limits<double>::quiet_NaN();
    return cell.empty() || parse(cell, value);
  }
  bool operator()(Count c) const { return parse(cell, record.work.*c.field); }
};

std::vector<std::string_view> split(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    cells.push_back(line.substr(begin, comma - begin));
    if (comma == std::string_view::npos) return cells;
    begin = comma + 1;
  }
}

// Place of every column of ours in the file's rows.
std::vector<std::size_t> find_columns(const std::string& file, std::string_view header) {
  const std::vector<std::string_view> names = split(header);
  std::vector<std::size_t> places;
  for (const Column& column : columns) {
    std::size_t place = 0;
    while (place < names.size() && names[place] != column.name)
      ++place;
    if (place == names.size()) {
      if (places.size() >= columns_required) {
        places.push_back(no_column);
        continue;
      }
      throw input_error("{}:1: column '{}' is missing; a frames.csv of a run directory is wanted", file,
                        column.name);
    }
    places.push_back(place);
  }
  return places;
}

}  // namespace

FrameCsvWriter::FrameCsvWriter(const std::filesystem::path& path) : file_(path) {
  for (const Column& column : columns) {
    if (!row_.empty()) row_ += ',';
    row_ += column.name;
  }
  row_ += '\n';
  file_.write(row_);
}

void FrameCsvWriter::append(const FrameRecord& record) {
  row_.clear();
  for (const Column& column : columns) {
    std::visit(CellWriter{record, row_}, column.field);
    row_ += ',';
  }
  row_.back() = '\n';
  file_.write(row_);
}

void FrameCsvWriter::close() {
  file_.close();
}

CostCsvWriter::CostCsvWriter(const std::filesystem::path& path) : file_(path) {
  file_.write(costs_csv_header());
}

void CostCsvWriter::append(const JobRecord& record) {
  row_.clear();
  append_costs_csv_row(row_, record);
  file_.write(row_);
}

void CostCsvWriter::close() {
  file_.close();
}

std::vector<FrameRecord> read_frames_csv(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  if (!stream || !std::getline(stream, line)) {
    throw input_error("{}: cannot be read: no such file, or empty; a frames.csv of a run directory is wanted",
                      file);
  }
  const std::vector<std::size_t> places = find_columns(file, line);
  std::vector<FrameRecord> records;
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    const std::vector<std::string_view> cells = split(line);
    FrameRecord record;
    for (std::size_t i = 0; i < std::size(columns); ++i) {
      if (places[i] == no_column) continue;
      if (places[i] >= cells.size()) {
        throw input_error("{}:{}: the row ends before column '{}'; was the file cut off?", file, number,
                          columns[i].name);
      }
      const std::string_view cell = cells[places[i]];
      if (std::visit(CellReader{record, cell}, columns[i].field)) continue;
      throw input_error("{}:{}: column '{}' has '{}'; a number is wanted", file, number, columns[i].name,
                        cell);
    }
    records.push_back(record);
  }
  return records;
}

}  // namespace brace
