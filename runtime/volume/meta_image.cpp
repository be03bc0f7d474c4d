#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "runtime/volume/formats.hpp"
#include "runtime/volume/header_text.hpp"

namespace brace {
namespace {

struct Entry {
  std::string value;
  std::string place;  // "file:line: key"
};

using Entries = std::map<std::string, Entry, std::less<>>;

/// "Key = value" lines up to ElementDataFile, which is the last one.
Entries read_entries(HeaderLines& lines) {
  Entries entries;
  while (const auto line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    const std::size_t equals = line->find('=');
    if (equals == std::string_view::npos)
      throw input_error("{}: '{}' is not 'key = value'", lines.place(), line->substr(0, 60));
    const std::string key(trimmed(line->substr(0, equals)));
    Entry entry{std::string(trimmed(line->substr(equals + 1))), fmt::format("{}: {}", lines.place(), key)};
    if (!entries.emplace(key, std::move(entry)).second)
      throw input_error("{}: '{}' is given twice", lines.place(), key);
    if (key == "ElementDataFile") return entries;
  }
  throw input_error("{}: not a MetaImage header: it has no ElementDataFile", lines.path().string());
}

const Entry* find(const Entries& entries, std::string_view key) {
  const auto found = entries.find(key);
  return found == entries.end() ? nullptr : &found->second;
}

const Entry& required(const Entries& entries, std::string_view key, const std::filesystem::path& path) {
  if (const Entry* entry = find(entries, key)) return *entry;
  throw input_error("{}: the MetaImage key '{}' is missing", path.string(), key);
}

bool read_bool(const Entries& entries, std::string_view key, bool otherwise) {
  const Entry* entry = find(entries, key);
  if (entry == nullptr) return otherwise;
  const std::string value = lowered(entry->value);
  if (value == "true" || value == "1") return true;
  if (value == "false" || value == "0") return false;
  throw input_error("{}: '{}' (accepted: True, False)", entry->place, entry->value);
}

void require_value(const Entries& entries, std::string_view key, std::string_view only) {
  const Entry* entry = find(entries, key);
  if (entry != nullptr && lowered(entry->value) != lowered(only))
    throw input_error("{}: '{}' (accepted: {})", entry->place, entry->value, only);
}

StoredType read_type(const Entry& entry) {
  static const std::map<std::string, StoredType, std::less<>> types{
      {"MET_CHAR", StoredType::int8},       {"MET_UCHAR", StoredType::uint8},
      {"MET_SHORT", StoredType::int16},     {"MET_USHORT", StoredType::uint16},
      {"MET_INT", StoredType::int32},       {"MET_UINT", StoredType::uint32},
      {"MET_LONG_LONG", StoredType::int64}, {"MET_ULONG_LONG", StoredType::uint64},
      {"MET_FLOAT", StoredType::float32},   {"MET_DOUBLE", StoredType::float64}};
  const auto type = types.find(entry.value);
  if (type == types.end())
    throw input_error("{}: '{}' (accepted: MET_ types of {})", entry.place, entry.value, accepted_types);
  return type->second;
}

void apply_spacing(const Entries& entries, VolumeInfo& info) {
  const Entry* entry = find(entries, "ElementSpacing");
  if (entry == nullptr) entry = find(entries, "ElementSize");
  if (entry == nullptr) return;
  const auto values = words(entry->value);
  if (values.size() != 3) throw input_error("{}: {} spacings (accepted: 3)", entry->place, values.size());
  for (std::size_t axis = 0; axis < 3; ++axis)
    info.spacing[axis] = checked_spacing(parse_number(values[axis], entry->place), entry->place);
  info.spacing_unit = "mm";  // the format's own unit
}

void apply_data_place(const Entries& entries, std::size_t header_bytes, StoredVolume& stored) {
  const Entry& file = required(entries, "ElementDataFile", stored.info.source);
  if (lowered(file.value) == "local") {
    stored.data_file = stored.info.source;
    stored.offset_bytes = header_bytes;
  } else if (file.value.starts_with("LIST") || file.value.find('%') != std::string::npos ||
             file.value.empty()) {
    throw input_error("{}: '{}' (accepted: LOCAL or one data file)", file.place, file.value);
  } else {
    stored.data_file = data_file_beside(stored.info.source, file.value);
  }
  if (const Entry* skip = find(entries, "HeaderSize")) {
    const std::int64_t bytes = parse_integer(skip->value, skip->place);
    if (bytes < -1) throw input_error("{}: {} (accepted: -1 or more)", skip->place, bytes);
    stored.data_at_end = bytes == -1 && stored.encoding == Encoding::raw;
    if (bytes > 0) stored.offset_bytes += static_cast<std::uint64_t>(bytes);
  }
}

}  // namespace

StoredVolume read_meta_image_header(const std::filesystem::path& path) {
  HeaderLines lines(path);
  const Entries entries = read_entries(lines);
  StoredVolume stored;
  stored.info.source = path.string();
  require_value(entries, "ObjectType", "Image");
  require_value(entries, "BinaryData", "True");
  require_value(entries, "ElementNumberOfChannels", "1");
  const Entry& count = required(entries, "NDims", path);
  if (parse_integer(count.value, count.place) != 3)
    throw input_error("{}: {} (accepted: 3)", count.place, count.value);
  const Entry& size = required(entries, "DimSize", path);
  std::vector<std::int64_t> dims;
  for (const std::string_view word : words(size.value))
    dims.push_back(parse_integer(word, size.place));
  stored.info.dims = checked_dims(dims, size.place);
  stored.stored_type = read_type(required(entries, "ElementType", path));
  choose_voxel_type(stored);
  apply_spacing(entries, stored.info);
  const bool big_endian = read_bool(entries, "BinaryDataByteOrderMSB", false);
  stored.big_endian = read_bool(entries, "ElementByteOrderMSB", big_endian);
  if (read_bool(entries, "CompressedData", false)) stored.encoding = Encoding::deflated;
  apply_data_place(entries, lines.offset_bytes(), stored);
  return stored;
}

}  // namespace brace
