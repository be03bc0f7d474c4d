#include "runtime/volume/generators.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/volume/row_generators.hpp"

namespace brace {
namespace {

constexpr std::string_view prefix = "generator:";

/// One row of samples at a time, quantised into the slab.
class GeneratorSource : public VolumeSource {
 public:
  GeneratorSource(VolumeInfo volume_info, std::unique_ptr<RowGenerator> rows)
      : VolumeSource(std::move(volume_info)),
        rows_(std::move(rows)),
        row_(static_cast<std::size_t>(info().dims[0])) {}

 private:
  void produce(std::span<std::byte> out, int z_begin, int z_count) override {
    const std::size_t row_bytes = row_.size() * bytes_per_voxel(info().type);
    std::size_t offset = 0;
    for (int z = z_begin; z < z_begin + z_count; ++z) {
      rows_->start_slice(z);
      for (int y = 0; y < info().dims[1]; ++y, offset += row_bytes) {
        rows_->row(y, row_);
        quantise(out.subspan(offset, row_bytes));
      }
    }
  }

  template <typename T>
  void store_scaled(std::span<std::byte> out, double scale, double rounding) const {
    for (std::size_t x = 0; x < row_.size(); ++x) {
      const T value = static_cast<T>(row_[x] * scale + rounding);
      std::memcpy(out.data() + x * sizeof(T), &value, sizeof(T));
    }
  }

  void quantise(std::span<std::byte> out) const {
    const double scale = full_scale(info().type);
    switch (info().type) {
      case VoxelType::uint8:
        return store_scaled<std::uint8_t>(out, scale, 0.5);
      case VoxelType::int16:
        return store_scaled<std::int16_t>(out, scale, 0.5);
      case VoxelType::uint16:
        return store_scaled<std::uint16_t>(out, scale, 0.5);
      case VoxelType::float32:
        return store_scaled<float>(out, scale, 0);
    }
  }

  std::unique_ptr<RowGenerator> rows_;
  std::vector<double> row_;
};

std::vector<std::string> generator_names() {
  std::vector<std::string> names;
  for (const GeneratorInfo& info : generators())
    names.push_back(info.name);
  return names;
}

[[noreturn]] void throw_unknown(const std::string& name) {
  const auto names = generator_names();
  throw input_error("volume: there is no generator '{}'{} (accepted: {})", name, did_you_mean(name, names),
                    join(names));
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t end = 0; end != std::string_view::npos;) {
    end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end != std::string_view::npos) text.remove_prefix(end + 1);
  }
  return parts;
}

int parse_size(const std::string& text, const std::string& whole) {
  int size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (error != std::errc{} || end != text.data() + text.size() || size < 1)
    throw input_error("volume '{}': '{}' is not a size (accepted: SIZE or XxYxZ, integers of 1 or more)",
                      whole, text);
  return size;
}

std::array<int, 3> parse_dims(const std::string& text, const std::string& whole) {
  const auto parts = split(text, 'x');
  if (parts.size() != 1 && parts.size() != 3)
    throw input_error("volume '{}': '{}' is not a size (accepted: SIZE or XxYxZ)", whole, text);
  std::array<int, 3> dims{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    dims[axis] = parse_size(parts.size() == 1 ? parts[0] : parts[axis], whole);
  if (dims[0] > max_voxels / dims[1] || std::int64_t{dims[0]} * dims[1] > max_voxels / dims[2])
    throw input_error("volume '{}': too many voxels (accepted: up to {})", whole, max_voxels);
  return dims;
}

VoxelType parse_type(const std::string& text, const std::string& whole) {
  for (const VoxelType type : {VoxelType::uint8, VoxelType::int16, VoxelType::uint16, VoxelType::float32})
    if (name_of(type) == text) return type;
  throw input_error("volume '{}': there is no type '{}' (accepted: uint8, int16, uint16, float32)", whole,
                    text);
}

}  // namespace

const std::vector<GeneratorInfo>& generators() {
  static const std::vector<GeneratorInfo> infos{
      {"marschner_lobb",
       "the Marschner-Lobb test signal (f_M = 6, alpha = 0.25): high frequencies everywhere"},
      {"solid_box", "full scale inside the middle half of each edge, 0 outside"},
      {"nested_shells", "four soft concentric shells; full scale inside, then 3/4, 1/2, 1/4 outwards"},
      {"fractal_vessels", "a branching tree of vessels in an empty box, always the same"},
      {"slab", "homogeneous: full scale everywhere"},
  };
  return infos;
}

double full_scale(VoxelType type) {
  switch (type) {
    case VoxelType::uint8:
      return 255;
    case VoxelType::int16:
      return 32767;
    case VoxelType::uint16:
      return 65535;
    case VoxelType::float32:
      return 1;
  }
  BRACE_CHECK(false);
  return 0;
}

bool is_generator(const std::string& text) {
  return text.starts_with(prefix);
}

GeneratorSpec parse_generator(const std::string& text) {
  BRACE_CHECK(is_generator(text));
  const auto parts = split(std::string_view(text).substr(prefix.size()), ':');
  if (parts.size() < 2 || parts.size() > 3)
    throw input_error("volume '{}': accepted is generator:NAME:SIZE[xSIZExSIZE][:TYPE] with the names {}",
                      text, join(generator_names()));
  GeneratorSpec spec;
  spec.name = parts[0];
  const auto names = generator_names();
  if (std::ranges::find(names, spec.name) == names.end()) throw_unknown(spec.name);
  spec.dims = parse_dims(parts[1], text);
  if (parts.size() == 3) spec.type = parse_type(parts[2], text);
  return spec;
}

std::string to_string(const GeneratorSpec& spec) {
  return fmt::format("{}{}:{}x{}x{}:{}", prefix, spec.name, spec.dims[0], spec.dims[1], spec.dims[2],
                     name_of(spec.type));
}

VolumeFormula generator_formula(const std::string& name) {
  if (name == "marschner_lobb") return marschner_lobb;
  if (name == "solid_box") return solid_box;
  if (name == "nested_shells") return nested_shells;
  if (name == "slab") return [](double, double, double) { return 1.0; };
  if (name == "fractal_vessels")
    return [tree = vessel_tree()](double x, double y, double z) { return vessels(tree, x, y, z); };
  throw_unknown(name);
}

std::unique_ptr<VolumeSource> open_generator(const GeneratorSpec& spec) {
  VolumeInfo info;
  info.dims = spec.dims;
  info.type = spec.type;
  info.source = to_string(spec);
  auto rows = make_row_generator(spec);
  if (!rows) throw_unknown(spec.name);
  return std::make_unique<GeneratorSource>(std::move(info), std::move(rows));
}

}  // namespace brace
