#include "runtime/volume/stored_volume.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "runtime/volume/byte_stream.hpp"
#include "runtime/volume/voxel_convert.hpp"

namespace brace {
namespace {

constexpr std::size_t convert_chunk_voxels = std::size_t{1} << 16;
constexpr std::size_t scan_slab_bytes = std::size_t{4} << 20;

std::uint64_t stored_byte_count(const StoredVolume& stored) {
  return static_cast<std::uint64_t>(stored.info.voxel_count()) * bytes_per_voxel(stored.stored_type);
}

[[noreturn]] void throw_truncated(const StoredVolume& stored, std::uint64_t found_bytes, const char* what) {
  const auto& dims = stored.info.dims;
  throw input_error("{}: truncated: {} x {} x {} voxels of {} bytes need {} bytes {}, found {}",
                    stored.data_file.string(), dims[0], dims[1], dims[2], bytes_per_voxel(stored.stored_type),
                    stored_byte_count(stored), what, found_bytes);
}

/// Where raw data begins after `skip_lines` lines. Throws if the file has fewer lines.
std::uint64_t offset_after_lines(const StoredVolume& stored) {
  if (stored.skip_lines == 0) return stored.offset_bytes;
  const auto stream = open_file_stream(stored.data_file, stored.offset_bytes);
  std::vector<std::byte> buffer(std::size_t{1} << 16);
  std::uint64_t offset = stored.offset_bytes;
  std::uint64_t lines = 0;
  for (std::size_t got = buffer.size(); got == buffer.size();) {
    got = stream->read(buffer);
    for (std::size_t i = 0; i < got; ++i) {
      if (buffer[i] != std::byte{'\n'}) continue;
      if (++lines == stored.skip_lines) return offset + i + 1;
    }
    offset += got;
  }
  throw input_error("{}: {} lines are to be skipped before the data, but it has only {}",
                    stored.data_file.string(), stored.skip_lines, lines);
}

/// The offset of the encoded data; throws unless the file can hold it.
std::uint64_t checked_data_offset(StoredVolume& stored) {
  const std::uint64_t file_bytes = regular_file_size(stored.data_file);
  const std::uint64_t needed = stored_byte_count(stored);
  if (stored.data_at_end) {
    if (file_bytes < stored.offset_bytes || file_bytes - stored.offset_bytes < needed)
      throw_truncated(stored, file_bytes - std::min(file_bytes, stored.offset_bytes), "of data");
    stored.skip_bytes = 0;
    return file_bytes - needed;
  }
  const std::uint64_t offset = offset_after_lines(stored);
  const std::uint64_t present = file_bytes - std::min(file_bytes, offset);
  const bool deflated = stored.encoding == Encoding::deflated;
  const std::uint64_t most = deflated ? max_inflated_bytes(present) : present;
  if (most < stored.skip_bytes || most - stored.skip_bytes < needed)
    throw_truncated(stored, deflated ? present : present - std::min(present, stored.skip_bytes),
                    deflated ? "of data, more than the file can unpack to" : "of data");
  if (!deflated && stored.exact_size && present - stored.skip_bytes != needed)
    throw input_error("{}: the data has {} bytes where {} x {} x {} voxels of {} bytes need {}",
                      stored.data_file.string(), present - stored.skip_bytes, stored.info.dims[0],
                      stored.info.dims[1], stored.info.dims[2], bytes_per_voxel(stored.stored_type), needed);
  return offset;
}

struct FiniteRange {
  float min = std::numeric_limits<float>::infinity();
  float max = -std::numeric_limits<float>::infinity();
  std::uint64_t not_finite = 0;
};

bool needs_no_conversion(const StoredVolume& stored) {
  if (stored.scaled()) return false;
  switch (stored.stored_type) {
    case StoredType::uint8:
    case StoredType::int16:
    case StoredType::uint16:
    case StoredType::float32:
      return true;
    default:
      return false;
  }
}

enum class NonFinite : std::uint8_t { pass, reject, replace };

class FileSource : public VolumeSource {
 public:
  FileSource(const StoredVolume& stored, std::uint64_t offset, NonFinite non_finite, FiniteRange range)
      : VolumeSource(stored.info),
        stored_(stored),
        non_finite_(non_finite),
        range_(range),
        stream_(stored.encoding == Encoding::deflated ? open_inflate_stream(stored.data_file, offset)
                                                      : open_file_stream(stored.data_file, offset)) {
    skip_bytes(*stream_, stored.skip_bytes);
  }

 private:
  void produce(std::span<std::byte> out, int z_begin, int /*z_count*/) override {
    const std::size_t first_voxel =
        static_cast<std::size_t>(z_begin) * (info().slice_bytes() / bytes_per_voxel(info().type));
    if (needs_no_conversion(stored_)) {
      read_stored(out);
    } else {
      read_and_convert(out, first_voxel);
    }
    if (info().type == VoxelType::float32 && non_finite_ != NonFinite::pass)
      treat_non_finite(out, first_voxel);
  }

  /// Fills `out` with voxels as stored, in host byte order.
  void read_stored(std::span<std::byte> out) {
    const std::size_t got = stream_->read(out);
    found_bytes_ += got;
    if (got < out.size()) throw_truncated(stored_, found_bytes_, "of data");
    if (stored_.big_endian != (std::endian::native == std::endian::big))
      swap_bytes(out, bytes_per_voxel(stored_.stored_type));
  }

  void read_and_convert(std::span<std::byte> out, std::size_t first_voxel) {
    const std::size_t from_size = bytes_per_voxel(stored_.stored_type);
    const std::size_t to_size = bytes_per_voxel(info().type);
    const std::size_t voxels = out.size() / to_size;
    buffer_.resize(std::min(voxels, convert_chunk_voxels) * from_size);
    for (std::size_t done = 0; done < voxels;) {
      const std::size_t count = std::min(voxels - done, convert_chunk_voxels);
      const auto chunk = std::span(buffer_).first(count * from_size);
      read_stored(chunk);
      if (const auto inexact = convert_voxels(stored_, chunk, out.subspan(done * to_size, count * to_size)))
        throw input_error("{}: voxel {} has the value {:.17g}, which {} cannot hold exactly (accepted: {})",
                          stored_.data_file.string(), place(first_voxel + done + inexact->index),
                          inexact->value, name_of(info().type), accepted_types);
      done += count;
    }
  }

  void treat_non_finite(std::span<std::byte> out, std::size_t first_voxel) {
    const std::span<float> voxels(reinterpret_cast<float*>(out.data()), out.size() / sizeof(float));
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      if (std::isfinite(voxels[i])) continue;
      if (non_finite_ == NonFinite::reject)
        throw input_error(
            "{}: voxel {} is {} (accepted: finite values; or ask for such voxels to be treated as empty)",
            stored_.data_file.string(), place(first_voxel + i), std::isnan(voxels[i]) ? "NaN" : "infinite");
      voxels[i] = voxels[i] > 0 ? range_.max : range_.min;
    }
  }

  std::string place(std::size_t voxel) const {
    const std::size_t width = static_cast<std::size_t>(info().dims[0]);
    const std::size_t height = static_cast<std::size_t>(info().dims[1]);
    return fmt::format("({}, {}, {})", voxel % width, voxel / width % height, voxel / width / height);
  }

  StoredVolume stored_;
  NonFinite non_finite_;
  FiniteRange range_;
  std::unique_ptr<ByteStream> stream_;
  std::uint64_t found_bytes_ = 0;
  std::vector<std::byte> buffer_;
};

FiniteRange scan_finite(VolumeSource& source, const Progress& progress) {
  FiniteRange range;
  const int depth = source.info().dims[2];
  const int step = slab_slices(source.info(), scan_slab_bytes);
  std::vector<std::byte> slab(static_cast<std::size_t>(step) * source.info().slice_bytes());
  for (int z = 0; z < depth; z += step) {
    const int count = std::min(step, depth - z);
    const auto part = std::span(slab).first(static_cast<std::size_t>(count) * source.info().slice_bytes());
    source.read_slab(part, z, count);
    for (const float value :
         std::span(reinterpret_cast<const float*>(part.data()), part.size() / sizeof(float))) {
      if (!std::isfinite(value)) {
        ++range.not_finite;
        continue;
      }
      range.min = std::min(range.min, value);
      range.max = std::max(range.max, value);
    }
    if (progress) progress(static_cast<double>(z + count) / depth);
  }
  if (range.min > range.max) range.min = range.max = 0;  // not one finite voxel
  return range;
}

}  // namespace

std::size_t bytes_per_voxel(StoredType type) {
  switch (type) {
    case StoredType::int8:
    case StoredType::uint8:
      return 1;
    case StoredType::int16:
    case StoredType::uint16:
      return 2;
    case StoredType::int32:
    case StoredType::uint32:
    case StoredType::float32:
      return 4;
    case StoredType::int64:
    case StoredType::uint64:
    case StoredType::float64:
      return 8;
  }
  BRACE_CHECK(false);
  return 0;
}

void choose_voxel_type(StoredVolume& stored) {
  VolumeInfo& info = stored.info;
  if (stored.scaled()) {
    info.type = VoxelType::float32;
    info.notes.push_back(fmt::format("value = {:.9g} * stored + {:.9g} applied; voxels became float32",
                                     stored.slope, stored.intercept));
    return;
  }
  switch (stored.stored_type) {
    case StoredType::uint8:
      info.type = VoxelType::uint8;
      return;
    case StoredType::int16:
      info.type = VoxelType::int16;
      return;
    case StoredType::uint16:
      info.type = VoxelType::uint16;
      return;
    case StoredType::float32:
      info.type = VoxelType::float32;
      return;
    case StoredType::int8:
      info.type = VoxelType::int16;
      info.notes.emplace_back("int8 voxels became int16");
      return;
    default:
      info.type = VoxelType::float32;
      info.notes.emplace_back("32- or 64-bit voxels became float32, each checked to be exact");
  }
}

std::array<int, 3> checked_dims(std::span<const std::int64_t> dims, const std::string& where) {
  if (dims.size() != 3) throw input_error("{}: {} dimensions given (accepted: 3)", where, dims.size());
  std::int64_t product = 1;
  std::array<int, 3> checked{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (dims[axis] < 1)
      throw input_error("{}: dimension {} is {} (accepted: 1 or more)", where, axis, dims[axis]);
    if (dims[axis] > max_voxels / product || dims[axis] > std::numeric_limits<int>::max())
      throw input_error("{}: {} x {} x {} voxels are too many (accepted: up to {})", where, dims[0], dims[1],
                        dims[2], max_voxels);
    product *= dims[axis];
    checked[axis] = static_cast<int>(dims[axis]);
  }
  return checked;
}

double checked_spacing(double spacing, const std::string& where) {
  // The bounds keep products and ratios of spacings finite.
  if (!(spacing >= 1e-30 && spacing <= 1e30))
    throw input_error("{}: a spacing of {} (accepted: 1e-30 to 1e30)", where, spacing);
  return spacing;
}

std::unique_ptr<VolumeSource> open_stored_volume(StoredVolume stored, const OpenOptions& options) {
  const std::uint64_t offset = checked_data_offset(stored);
  if (stored.info.type != VoxelType::float32 || options.non_finite == NonFinitePolicy::reject)
    return std::make_unique<FileSource>(stored, offset, NonFinite::reject, FiniteRange{});
  FileSource first_pass(stored, offset, NonFinite::pass, FiniteRange{});
  const FiniteRange range = scan_finite(first_pass, options.progress);
  if (range.not_finite > 0)
    stored.info.notes.push_back(
        fmt::format("{} voxels are NaN or infinite: NaN and -Inf read as {:.9g}, +Inf as {:.9g}",
                    range.not_finite, range.min, range.max));
  return std::make_unique<FileSource>(stored, offset, NonFinite::replace, range);
}

}  // namespace brace
