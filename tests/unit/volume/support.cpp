#include "tests/unit/volume/support.hpp"

#include <cstdlib>
#include <fstream>

#include <unistd.h>
#include <zlib.h>

namespace brace {
namespace {

std::string deflated(std::string_view bytes, int window_bits) {
  z_stream zlib{};
  BRACE_CHECK(deflateInit2(&zlib, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string result(deflateBound(&zlib, bytes.size()) + 64, '\0');
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  zlib.avail_in = static_cast<uInt>(bytes.size());
  zlib.next_out = reinterpret_cast<Bytef*>(result.data());
  zlib.avail_out = static_cast<uInt>(result.size());
  BRACE_CHECK(deflate(&zlib, Z_FINISH) == Z_STREAM_END);
  result.resize(zlib.total_out);
  deflateEnd(&zlib);
  return result;
}

}  // namespace

FolderTest::FolderTest() {
  std::string pattern = (std::filesystem::temp_directory_path() / "brace_volume_XXXXXX").string();
  folder = mkdtemp(pattern.data());
}

FolderTest::~FolderTest() {
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

std::filesystem::path FolderTest::write(const std::string& name, std::string_view bytes) const {
  const std::filesystem::path path = folder / name;
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

std::string gzipped(std::string_view bytes) {
  return deflated(bytes, 15 + 16);
}
std::string zlib_compressed(std::string_view bytes) {
  return deflated(bytes, 15);
}

Volume load(const std::string& path_or_generator, const OpenOptions& options) {
  const auto source = open_volume(path_or_generator, options);
  return load_volume(*source);
}

std::vector<double> values_of(const Volume& volume) {
  std::vector<double> values(static_cast<std::size_t>(volume.info.voxel_count()));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = voxel_value(volume.info.type, volume.voxels, i);
  return values;
}

std::string error_of(const std::string& path_or_generator, const OpenOptions& options) {
  try {
    load(path_or_generator, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  ADD_FAILURE() << path_or_generator << " was read without an error";
  return "";
}

std::filesystem::path preset_folder() {
  return std::filesystem::path(BRACE_SOURCE_DIR) / "runtime/volume/transfer_functions";
}

std::filesystem::path shared_volumes() {
  const char* shared = std::getenv("BRACE_SHARED_DIR");
  const std::filesystem::path root =
      shared != nullptr ? shared : std::filesystem::path(BRACE_SOURCE_DIR).parent_path() / "shared";
  const std::filesystem::path volumes = root / "data/volumes";
  return std::filesystem::is_directory(volumes) ? volumes : std::filesystem::path();
}

}  // namespace brace
