#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/volume/formats.hpp"
#include "runtime/volume/header_text.hpp"

namespace brace {
namespace {

struct Field {
  std::string value;
  std::string place;  // "file:line: name"
};

constexpr std::size_t longest_field_name = 40;

using Fields = std::map<std::string, Field, std::less<>>;

/// All the format's fields; those not asked for below do not change the voxels.
const std::vector<std::string>& known_fields() {
  static const std::vector<std::string> names{"type",         "dimension",
                                              "space",        "space dimension",
                                              "sizes",        "spacings",
                                              "thicknesses",  "axis mins",
                                              "axismins",     "axis maxs",
                                              "axismaxs",     "centers",
                                              "centerings",   "labels",
                                              "units",        "kinds",
                                              "min",          "max",
                                              "old min",      "oldmin",
                                              "old max",      "oldmax",
                                              "content",      "sample units",
                                              "sampleunits",  "endian",
                                              "encoding",     "line skip",
                                              "lineskip",     "byte skip",
                                              "byteskip",     "data file",
                                              "datafile",     "space units",
                                              "space origin", "space directions",
                                              "block size",   "measurement frame",
                                              "blocksize",    "number"};
  return names;
}

std::string canonical(const std::string& name) {
  if (name == "lineskip") return "line skip";
  if (name == "byteskip") return "byte skip";
  if (name == "datafile") return "data file";
  return name;
}

void add_field(Fields& fields, std::string_view line, const std::string& place) {
  const std::size_t colon = line.find(": ");
  const std::size_t end = colon != std::string_view::npos ? colon : line.find(':');
  if (end == std::string_view::npos)
    throw input_error("{}: '{}' is not 'field: value'", place, line.substr(0, 60));
  if (colon == std::string_view::npos && end + 1 < line.size() && line[end + 1] == '=') return;  // key:=value
  const std::string name = lowered(trimmed(line.substr(0, std::min(end, longest_field_name))));
  if (std::ranges::find(known_fields(), name) == known_fields().end()) {
    if (line.find(":=") != std::string_view::npos) return;  // key:=value with ": " inside
    throw input_error("{}: '{}' is no NRRD field{}", place, name, did_you_mean(name, known_fields()));
  }
  Field field{std::string(trimmed(line.substr(end + 1))), fmt::format("{}: {}", place, name)};
  if (!fields.emplace(canonical(name), std::move(field)).second)
    throw input_error("{}: '{}' is given twice", place, name);
}

/// Reads up to the blank line that ends the header, or to the end of a detached one.
Fields read_fields(HeaderLines& lines) {
  const auto magic = lines.next();
  if (!magic || !magic->starts_with("NRRD000") || magic->size() != 8 || (*magic)[7] < '1' ||
      (*magic)[7] > '5')
    throw input_error("{}: not a NRRD header (accepted: a first line of NRRD0001 to NRRD0005)",
                      lines.place());
  Fields fields;
  while (const auto line = lines.next()) {
    if (line->empty()) break;
    if (line->front() != '#') add_field(fields, *line, lines.place());
  }
  return fields;
}

const Field& required(const Fields& fields, const std::string& name, const std::filesystem::path& path) {
  const auto found = fields.find(name);
  if (found == fields.end()) throw input_error("{}: the NRRD field '{}' is missing", path.string(), name);
  return found->second;
}

const Field* optional_field(const Fields& fields, const std::string& name) {
  const auto found = fields.find(name);
  return found == fields.end() ? nullptr : &found->second;
}

StoredType parse_type(const Field& field) {
  const std::string name = lowered(field.value);
  static const std::map<std::string, StoredType, std::less<>> aliases{
      {"signed char", StoredType::int8},
      {"int8_t", StoredType::int8},
      {"uchar", StoredType::uint8},
      {"unsigned char", StoredType::uint8},
      {"uint8_t", StoredType::uint8},
      {"short", StoredType::int16},
      {"short int", StoredType::int16},
      {"signed short", StoredType::int16},
      {"signed short int", StoredType::int16},
      {"int16_t", StoredType::int16},
      {"ushort", StoredType::uint16},
      {"unsigned short", StoredType::uint16},
      {"unsigned short int", StoredType::uint16},
      {"uint16_t", StoredType::uint16},
      {"int", StoredType::int32},
      {"signed int", StoredType::int32},
      {"int32_t", StoredType::int32},
      {"uint", StoredType::uint32},
      {"unsigned int", StoredType::uint32},
      {"uint32_t", StoredType::uint32},
      {"longlong", StoredType::int64},
      {"long long", StoredType::int64},
      {"long long int", StoredType::int64},
      {"signed long long", StoredType::int64},
      {"signed long long int", StoredType::int64},
      {"int64_t", StoredType::int64},
      {"ulonglong", StoredType::uint64},
      {"unsigned long long", StoredType::uint64},
      {"unsigned long long int", StoredType::uint64},
      {"uint64_t", StoredType::uint64},
      {"float", StoredType::float32},
      {"double", StoredType::float64}};
  if (const auto type = stored_type_of(name);
      type && *type != StoredType::float32 && *type != StoredType::float64)
    return *type;
  const auto alias = aliases.find(name);
  if (alias == aliases.end())
    throw input_error("{}: '{}' (accepted: {})", field.place, field.value, accepted_types);
  return alias->second;
}

/// "(1,0,0) (0,1,0) (0,0,1)" to vectors.
std::vector<std::vector<double>> parse_directions(const Field& field) {
  std::vector<std::vector<double>> vectors;
  std::string_view rest = trimmed(field.value);
  while (!rest.empty()) {
    const std::size_t close = rest.find(')');
    if (rest.front() != '(' || close == std::string_view::npos)
      throw input_error("{}: '{}' (accepted: three vectors such as (1,0,0))", field.place,
                        rest.substr(0, 60));
    std::string inside(rest.substr(1, close - 1));
    std::ranges::replace(inside, ',', ' ');
    std::vector<double>& vector = vectors.emplace_back();
    for (const std::string_view word : words(inside))
      vector.push_back(parse_number(word, field.place));
    rest = trimmed(rest.substr(close + 1));
  }
  return vectors;
}

/// The letters of a space's axes ("LPS"), or "" for a space that is not anatomical.
std::string space_letters(const Fields& fields) {
  const Field* space = optional_field(fields, "space");
  if (space == nullptr) return "";
  const std::string name = lowered(space->value);
  if (name == "right-anterior-superior" || name == "ras") return "RAS";
  if (name == "left-anterior-superior" || name == "las") return "LAS";
  if (name == "left-posterior-superior" || name == "lps") return "LPS";
  return "";
}

char opposite(char letter) {
  constexpr std::string_view letters = "LRAPSI";
  constexpr std::string_view opposites = "RLPAIS";
  return opposites[letters.find(letter)];
}

void apply_directions(const Field& field, const std::string& space, VolumeInfo& info) {
  const auto vectors = parse_directions(field);
  if (vectors.size() != 3)
    throw input_error("{}: {} vectors (accepted: 3, one per axis)", field.place, vectors.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double length = 0;
    for (const double component : vectors[axis])
      length = std::hypot(length, component);
    info.spacing[axis] = checked_spacing(length, field.place);
    if (space.empty() || vectors[axis].size() != 3) continue;
    const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto largest = std::ranges::max_element(vectors[axis], larger);
    const char letter = space[static_cast<std::size_t>(largest - vectors[axis].begin())];
    info.orientation += *largest > 0 ? letter : opposite(letter);
  }
  // Two axes may lean the same way in a sheared grid: then the letters say nothing.
  for (const char letter : info.orientation)
    if (std::ranges::count(info.orientation, letter) +
            std::ranges::count(info.orientation, opposite(letter)) >
        1)
      return info.orientation.clear();
}

void apply_spacings(const Field& field, VolumeInfo& info) {
  const auto values = words(field.value);
  if (values.size() != 3) throw input_error("{}: {} spacings (accepted: 3)", field.place, values.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spacing = std::abs(parse_number(values[axis], field.place));  // negative: a flipped axis
    if (!std::isnan(spacing)) info.spacing[axis] = checked_spacing(spacing, field.place);  // NaN: not known
  }
}

/// The unit if all three axes have the same and it is one that VolumeInfo knows.
std::string common_unit(const Fields& fields) {
  const Field* field = optional_field(fields, "space units");
  if (field == nullptr) field = optional_field(fields, "units");
  if (field == nullptr) return "";
  for (const std::string unit : {"m", "mm", "um"})
    if (words(field->value) == std::vector<std::string_view>(3, "\"" + unit + "\"")) return unit;
  return "";
}

std::uint64_t parse_skip(const Field& field) {
  const std::int64_t count = parse_integer(field.value, field.place);
  if (count < 0) throw input_error("{}: {} (accepted: 0 or more)", field.place, count);
  return static_cast<std::uint64_t>(count);
}

void apply_encoding(const Fields& fields, StoredVolume& stored) {
  const Field& encoding = required(fields, "encoding", stored.info.source);
  const std::string name = lowered(encoding.value);
  if (name == "gzip" || name == "gz") {
    stored.encoding = Encoding::deflated;
  } else if (name != "raw") {
    throw input_error("{}: unknown encoding '{}' (accepted: raw, gzip)", encoding.place, encoding.value);
  }
  if (bytes_per_voxel(stored.stored_type) > 1) {
    const Field& endian = required(fields, "endian", stored.info.source);
    const std::string order = lowered(endian.value);
    if (order != "big" && order != "little")
      throw input_error("{}: '{}' (accepted: little, big)", endian.place, endian.value);
    stored.big_endian = order == "big";
  }
  if (const Field* skip = optional_field(fields, "line skip")) stored.skip_lines = parse_skip(*skip);
  if (const Field* skip = optional_field(fields, "byte skip")) {
    // -1: the data is the end of the file, whatever its header's length.
    stored.data_at_end = skip->value == "-1" && stored.encoding == Encoding::raw;
    if (!stored.data_at_end) stored.skip_bytes = parse_skip(*skip);
  }
}

void apply_data_file(const Fields& fields, std::size_t header_bytes, StoredVolume& stored) {
  const Field* data_file = optional_field(fields, "data file");
  if (data_file == nullptr) {
    stored.data_file = stored.info.source;
    stored.offset_bytes = header_bytes;
    return;
  }
  if (data_file->value.starts_with("LIST") || data_file->value.find('%') != std::string::npos)
    throw input_error("{}: '{}' (accepted: one data file)", data_file->place, data_file->value);
  stored.data_file = data_file_beside(stored.info.source, data_file->value);
}

}  // namespace

StoredVolume read_nrrd_header(const std::filesystem::path& path) {
  HeaderLines lines(path);
  const Fields fields = read_fields(lines);
  StoredVolume stored;
  stored.info.source = path.string();

  const Field& dimension = required(fields, "dimension", path);
  if (parse_integer(dimension.value, dimension.place) != 3)
    throw input_error("{}: {} (accepted: 3)", dimension.place, dimension.value);
  const Field& sizes = required(fields, "sizes", path);
  std::vector<std::int64_t> dims;
  for (const std::string_view word : words(sizes.value))
    dims.push_back(parse_integer(word, sizes.place));
  stored.info.dims = checked_dims(dims, sizes.place);
  stored.stored_type = parse_type(required(fields, "type", path));
  choose_voxel_type(stored);

  if (const Field* spacings = optional_field(fields, "spacings")) apply_spacings(*spacings, stored.info);
  if (const Field* directions = optional_field(fields, "space directions"))
    apply_directions(*directions, space_letters(fields), stored.info);
  stored.info.spacing_unit = common_unit(fields);
  apply_encoding(fields, stored);
  apply_data_file(fields, lines.offset_bytes(), stored);
  return stored;
}

}  // namespace brace
