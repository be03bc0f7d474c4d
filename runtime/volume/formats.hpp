#pragma once

#include <filesystem>

#include "runtime/volume/stored_volume.hpp"

namespace brace {

// One reader per format: from a header to what is stored where. They read the header only. Each throws
// brace::Error (exit code 2) that names the file and the line or field.

/// NRRD 1 to 5, three dimensions, attached or with one detached data file, raw or gzip. `space directions`
/// give the spacings (their lengths); their rotation is left aside but for VolumeInfo::orientation.
/// Hand-written: teem opens whatever file a header names and leaks on malformed headers.
StoredVolume read_nrrd_header(const std::filesystem::path& path);

/// NIfTI-1 in one file, plain or gzip. A scl_slope and scl_inter other than the identity are applied in
/// double and rounded to float32.
StoredVolume read_nifti_header(const std::filesystem::path& path);

/// MetaImage: .mha (ElementDataFile = LOCAL) and .mhd with one data file, plain or zlib.
StoredVolume read_meta_image_header(const std::filesystem::path& path);

/// `path`.toml describes the raw file `path`: dims, type, and optionally spacing, spacing_unit, endian,
/// header_bytes.
StoredVolume read_raw_sidecar(const std::filesystem::path& path);

}  // namespace brace
