#include <array>
#include <cstring>
#include <string>

#include "base/error.hpp"
#include "runtime/volume/byte_stream.hpp"
#include "runtime/volume/formats.hpp"
#include "runtime/volume/generators.hpp"
#include "runtime/volume/header_text.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {
namespace {

constexpr const char* accepted_volumes =
    ".nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd, .raw with a sidecar .raw.toml, or generator:NAME:SIZE";

enum class Format : std::uint8_t { nrrd, nifti, meta_image, raw };

bool looks_like_meta_image(std::string_view head) {
  for (const std::string_view key : {"ObjectType", "NDims", "Comment", "ElementType", "DimSize"})
    if (head.starts_with(key)) return true;
  return false;
}

/// A raw file's bytes may look like anything, so its name comes first.
Format format_of(const std::filesystem::path& path) {
  const std::string name = lowered(path.filename().string());
  if (name.ends_with(".raw") || std::filesystem::exists(path.string() + ".toml")) return Format::raw;

  std::array<char, 352> buffer{};
  const std::size_t got = open_file_stream(path, 0)->read(std::as_writable_bytes(std::span(buffer)));
  const std::string_view head(buffer.data(), got);
  if (head.starts_with("NRRD")) return Format::nrrd;
  if (looks_like_meta_image(head)) return Format::meta_image;
  if (head.size() >= 348 && (head.substr(344, 4) == std::string_view("n+1\0", 4))) return Format::nifti;

  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return Format::nrrd;
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return Format::nifti;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return Format::meta_image;
  throw input_error("{}: not a volume that is known by its first bytes or its name (accepted: {})",
                    path.string(), accepted_volumes);
}

StoredVolume read_header(Format format, const std::filesystem::path& path) {
  switch (format) {
    case Format::nrrd:
      return read_nrrd_header(path);
    case Format::nifti:
      return read_nifti_header(path);
    case Format::meta_image:
      return read_meta_image_header(path);
    case Format::raw:
      return read_raw_sidecar(path);
  }
  BRACE_CHECK(false);
  return {};
}

}  // namespace

std::unique_ptr<VolumeSource> open_volume(const std::string& path_or_generator, const OpenOptions& options) {
  if (is_generator(path_or_generator)) return open_generator(parse_generator(path_or_generator));
  std::filesystem::path path = path_or_generator;
  if (path_or_generator.ends_with(".raw.toml")) path.replace_extension();
  regular_file_size(path);
  return open_stored_volume(read_header(format_of(path), path), options);
}

}  // namespace brace
