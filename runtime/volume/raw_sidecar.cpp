#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/toml_file.hpp"
#include "runtime/volume/byte_stream.hpp"
#include "runtime/volume/formats.hpp"
#include "runtime/volume/header_text.hpp"

namespace brace {
namespace {

constexpr std::uint64_t longest_sidecar_bytes = 1 << 16;

std::string where(const toml::table& table, const char* key, const std::string& file) {
  const toml::node* node = table.get(key);
  return fmt::format("{}: {}", node != nullptr ? place_of(*node, file) : file, key);
}

std::array<int, 3> read_dims(const toml::table& table, const std::string& file) {
  const toml::array* array = table["dims"].as_array();
  const std::string place = where(table, "dims", file);
  if (array == nullptr) throw input_error("{}: missing or not an array (accepted: dims = [x, y, z])", place);
  std::vector<std::int64_t> dims;
  for (const toml::node& node : *array) {
    const auto size = node.value_exact<std::int64_t>();
    if (!size) throw input_error("{}: not an integer (accepted: dims = [x, y, z])", place);
    dims.push_back(*size);
  }
  return checked_dims(dims, place);
}

std::string read_string(const toml::table& table, const char* key, const std::string& file,
                        const std::string& otherwise, const char* accepted) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return otherwise;
  const auto text = node->value_exact<std::string>();
  if (!text) throw input_error("{}: not a string (accepted: {})", where(table, key, file), accepted);
  return *text;
}

void apply_spacing(const toml::table& table, const std::string& file, VolumeInfo& info) {
  if (const toml::node* node = table.get("spacing")) {
    const toml::array* array = node->as_array();
    const std::string place = where(table, "spacing", file);
    if (array == nullptr || array->size() != 3) throw input_error("{}: accepted: spacing = [x, y, z]", place);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto spacing = array->get(axis)->value<double>();
      if (!spacing) throw input_error("{}: not a number", place);
      info.spacing[axis] = checked_spacing(*spacing, place);
    }
  }
  constexpr const char* units = "m, mm, um";
  info.spacing_unit = read_string(table, "spacing_unit", file, "", units);
  if (!info.spacing_unit.empty() && !spacing_unit_m(info))
    throw input_error("{}: '{}' (accepted: {})", where(table, "spacing_unit", file), info.spacing_unit,
                      units);
}

}  // namespace

StoredVolume read_raw_sidecar(const std::filesystem::path& path) {
  const std::filesystem::path sidecar = path.string() + ".toml";
  const std::string file = sidecar.string();
  if (!std::filesystem::exists(sidecar))
    throw input_error(
        "{}: a raw file needs a sidecar {} with dims, type and optionally spacing, spacing_unit, "
        "endian, header_bytes",
        path.string(), file);
  if (regular_file_size(sidecar) > longest_sidecar_bytes)
    throw input_error("{}: too long for a sidecar (accepted: up to {} bytes)", file, longest_sidecar_bytes);
  const toml::table table = read_toml_file(sidecar);
  reject_unknown_keys(table, file, "", {"dims", "type", "spacing", "spacing_unit", "endian", "header_bytes"});

  StoredVolume stored;
  stored.info.source = path.string();
  stored.info.dims = read_dims(table, file);
  const std::string type = read_string(table, "type", file, "", accepted_types);
  const auto stored_type = stored_type_of(type);
  if (!stored_type)
    throw input_error("{}: '{}' (accepted: {})", where(table, "type", file), type, accepted_types);
  stored.stored_type = *stored_type;
  choose_voxel_type(stored);
  apply_spacing(table, file, stored.info);

  const std::string endian = read_string(table, "endian", file, "little", "little, big");
  if (endian != "little" && endian != "big")
    throw input_error("{}: '{}' (accepted: little, big)", where(table, "endian", file), endian);
  stored.big_endian = endian == "big";
  if (const toml::node* node = table.get("header_bytes")) {
    const auto bytes = node->value_exact<std::int64_t>();
    if (!bytes || *bytes < 0)
      throw input_error("{}: accepted: an integer, 0 or more", where(table, "header_bytes", file));
    stored.offset_bytes = static_cast<std::uint64_t>(*bytes);
  }
  stored.data_file = path;
  stored.exact_size = true;
  return stored;
}

}  // namespace brace
