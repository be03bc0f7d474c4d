#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>

#include <nifti/nifti1_io.h>

#include "base/error.hpp"
#include "runtime/volume/byte_stream.hpp"
#include "runtime/volume/formats.hpp"

namespace brace {
namespace {

constexpr std::size_t header_bytes = 348;
static_assert(sizeof(nifti_1_header) == header_bytes);

struct RawHeader {
  nifti_1_header header;  // host byte order
  bool swapped = false;
  bool compressed = false;
};

RawHeader read_raw_header(const std::filesystem::path& path) {
  RawHeader result;
  std::array<std::byte, 2> magic{};
  regular_file_size(path);
  open_file_stream(path, 0)->read(magic);
  result.compressed = magic[0] == std::byte{0x1f} && magic[1] == std::byte{0x8b};
  const auto stream = result.compressed ? open_inflate_stream(path, 0) : open_file_stream(path, 0);
  std::array<std::byte, header_bytes> bytes{};
  const std::size_t got = stream->read(bytes);
  if (got < header_bytes)
    throw input_error("{}: truncated: a NIfTI header has {} bytes, found {}", path.string(), header_bytes,
                      got);
  std::memcpy(&result.header, bytes.data(), header_bytes);
  constexpr int nifti2_header_bytes = 540;
  int size = result.header.sizeof_hdr;
  if (size == static_cast<int>(__builtin_bswap32(header_bytes))) {
    result.swapped = true;
    swap_nifti_header(&result.header, 1);
    size = result.header.sizeof_hdr;
  }
  if (size == nifti2_header_bytes || size == static_cast<int>(__builtin_bswap32(nifti2_header_bytes)))
    throw input_error("{}: is a NIfTI-2 file (accepted: NIfTI-1)", path.string());
  if (size != static_cast<int>(header_bytes) || std::memcmp(result.header.magic, "n+1", 4) != 0)
    throw input_error("{}: not a NIfTI-1 file of one piece (accepted: sizeof_hdr 348 and magic \"n+1\")",
                      path.string());
  return result;
}

/// Three dims; those a header leaves out or sets to 1 behind them do not matter.
std::array<int, 3> read_dims(const nifti_1_header& header, const std::string& where) {
  const int count = header.dim[0];
  if (count < 1 || count > 7) throw input_error("{}: dim[0] is {} (accepted: 1 to 7)", where, count);
  std::array<std::int64_t, 3> dims{1, 1, 1};
  for (int i = 1; i <= count; ++i) {
    const std::int64_t size = header.dim[i];
    if (i <= 3) {
      dims[static_cast<std::size_t>(i - 1)] = size;
    } else if (size != 1) {
      throw input_error("{}: dim[{}] is {} (accepted: one volume, that is 1)", where, i, size);
    }
  }
  return checked_dims(dims, where + ": dim");
}

StoredType read_type(const nifti_1_header& header, const std::string& where) {
  switch (header.datatype) {
    case NIFTI_TYPE_INT8:
      return StoredType::int8;
    case NIFTI_TYPE_UINT8:
      return StoredType::uint8;
    case NIFTI_TYPE_INT16:
      return StoredType::int16;
    case NIFTI_TYPE_UINT16:
      return StoredType::uint16;
    case NIFTI_TYPE_INT32:
      return StoredType::int32;
    case NIFTI_TYPE_UINT32:
      return StoredType::uint32;
    case NIFTI_TYPE_INT64:
      return StoredType::int64;
    case NIFTI_TYPE_UINT64:
      return StoredType::uint64;
    case NIFTI_TYPE_FLOAT32:
      return StoredType::float32;
    case NIFTI_TYPE_FLOAT64:
      return StoredType::float64;
    default:
      throw input_error("{}: datatype {} (accepted: {})", where, header.datatype, accepted_types);
  }
}

std::string unit_name(int xyz_units) {
  switch (xyz_units) {
    case NIFTI_UNITS_METER:
      return "m";
    case NIFTI_UNITS_MM:
      return "mm";
    case NIFTI_UNITS_MICRON:
      return "um";
    default:
      return "";
  }
}

/// Letters of the directions in which x, y, z grow, by the sform if there is one, else the qform.
std::string orientation_letters(const nifti_image& image) {
  if (image.sform_code <= 0 && image.qform_code <= 0) return "";
  std::array<int, 3> directions{};
  nifti_mat44_to_orientation(image.sform_code > 0 ? image.sto_xyz : image.qto_xyz, &directions[0],
                             &directions[1], &directions[2]);
  std::string letters;
  for (const int direction : directions) {
    switch (direction) {
      case NIFTI_L2R:
        letters += 'R';
        break;
      case NIFTI_R2L:
        letters += 'L';
        break;
      case NIFTI_P2A:
        letters += 'A';
        break;
      case NIFTI_A2P:
        letters += 'P';
        break;
      case NIFTI_I2S:
        letters += 'S';
        break;
      case NIFTI_S2I:
        letters += 'I';
        break;
      default:
        return "";
    }
  }
  return letters;
}

/// Spacing, unit and orientation, which nifticlib works out of pixdim, qform and sform. The header was
/// checked, so that the library has nothing to complain of.
void apply_geometry(const nifti_1_header& header, const std::string& where, VolumeInfo& info) {
  nifti_set_debug_level(0);
  const std::unique_ptr<nifti_image, decltype(&nifti_image_free)> image(
      nifti_convert_nhdr2nim(header, nullptr), &nifti_image_free);
  if (!image) throw input_error("{}: nifticlib does not accept the header", where);
  // The file's own numbers: the library reads what is not finite as 0.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = std::abs(static_cast<double>(header.pixdim[axis + 1]));
    info.spacing[axis] = length == 0 ? 1.0 : checked_spacing(length, where + ": pixdim");  // 0: not stated
  }
  info.spacing_unit = unit_name(image->xyz_units);
  info.orientation = orientation_letters(*image);
}

}  // namespace

StoredVolume read_nifti_header(const std::filesystem::path& path) {
  const RawHeader raw = read_raw_header(path);
  const nifti_1_header& header = raw.header;
  StoredVolume stored;
  stored.info.source = path.string();
  stored.info.dims = read_dims(header, path.string());
  stored.stored_type = read_type(header, path.string());
  if (std::isfinite(header.scl_slope) && std::isfinite(header.scl_inter) && header.scl_slope != 0) {
    stored.slope = static_cast<double>(header.scl_slope);
    stored.intercept = static_cast<double>(header.scl_inter);
  }
  choose_voxel_type(stored);
  apply_geometry(header, path.string(), stored.info);

  constexpr float largest_offset = 1e9F;
  if (!(header.vox_offset >= static_cast<float>(header_bytes) && header.vox_offset <= largest_offset))
    throw input_error("{}: vox_offset is {} (accepted: {} to {:.0f})", path.string(), header.vox_offset,
                      header_bytes, largest_offset);
  stored.data_file = path;
  stored.skip_bytes = static_cast<std::uint64_t>(header.vox_offset);
  stored.encoding = raw.compressed ? Encoding::deflated : Encoding::raw;
  stored.big_endian = (std::endian::native == std::endian::big) != raw.swapped;
  return stored;
}

}  // namespace brace
