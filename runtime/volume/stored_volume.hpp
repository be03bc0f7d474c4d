#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "runtime/volume/volume.hpp"

namespace brace {

// What the format readers share. A reader turns a header into a StoredVolume and opens nothing else; one
// source streams them all.

/// Types that files hold. Those that are not a VoxelType are converted where that loses nothing: int8 to
/// int16; the 32- and 64-bit types to float32, each voxel checked.
enum class StoredType : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64
};

enum class Encoding : std::uint8_t { raw, deflated };  // deflated: gzip or zlib

std::size_t bytes_per_voxel(StoredType type);

/// For error messages.
inline constexpr const char* accepted_types =
    "uint8, int16, uint16, float32; int8 (becomes int16); int32, uint32, int64, uint64, float64 (become "
    "float32 "
    "where that is exact)";

struct StoredVolume {
  VolumeInfo info;  // type is what the voxels become
  std::filesystem::path data_file;
  std::uint64_t offset_bytes = 0;  // in the file, where the encoded data begins
  std::uint64_t skip_lines = 0;    // from there, in the file as it is
  std::uint64_t skip_bytes = 0;    // after that, in the decoded data
  bool data_at_end = false;        // raw only: the data is the file's last bytes, whatever stands before them
  bool exact_size = false;         // raw only: the file must end with the data
  Encoding encoding = Encoding::raw;
  StoredType stored_type = StoredType::uint8;
  bool big_endian = false;
  double slope = 1;  // value = slope * stored + intercept; float32 unless both are the identity
  double intercept = 0;

  bool scaled() const { return slope != 1 || intercept != 0; }
};

/// Sets info.type from the stored type and the scale, and notes the conversion.
void choose_voxel_type(StoredVolume& stored);

/// Throws brace::Error, naming `where` ("file: field"), unless there are three dims >= 1 whose product is at
/// most max_voxels.
std::array<int, 3> checked_dims(std::span<const std::int64_t> dims, const std::string& where);

/// Throws unless finite and > 0.
double checked_spacing(double spacing, const std::string& where);

/// Checks the data file against the header and opens it. Throws brace::Error (exit code 2) with the bytes
/// expected and found if the file cannot hold the data; nothing of the data's size is allocated.
std::unique_ptr<VolumeSource> open_stored_volume(StoredVolume stored, const OpenOptions& options);

}  // namespace brace
