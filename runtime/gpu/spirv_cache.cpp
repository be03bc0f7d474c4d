#include "runtime/gpu/spirv_cache.hpp"

#include <atomic>
#include <bit>
#include <cstdlib>
#include <fstream>

#include <fmt/core.h>
#include <unistd.h>

#include "runtime/gpu/shader_compiler.hpp"

namespace brace::gpu {
namespace {

struct EntryHeader {
  std::uint32_t magic = 0x53525242;  // "BRRS", also tells a foreign byte order
  std::uint32_t version = 1;
  std::uint64_t words = 0;
  std::uint64_t checksum = 0;
};
static_assert(sizeof(EntryHeader) == 24);

constexpr std::uint64_t words_max = 64u << 20;

std::uint64_t checksum(std::span<const std::uint32_t> words) {
  std::uint64_t state = 0xcbf29ce484222325;
  for (const std::uint32_t word : words)
    state = std::rotl((state ^ word) * 0x100000001b3, 23);
  return state;
}

std::filesystem::path entry_path(const std::filesystem::path& folder, const std::string& key) {
  return folder / (key + ".spv");
}

}  // namespace

std::filesystem::path default_cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
    return std::filesystem::path(cache) / "brace" / "spirv";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache" / "brace" / "spirv";
  return {};
}

std::optional<std::vector<std::uint32_t>> read_cache_entry(const std::filesystem::path& folder,
                                                           const std::string& key) {
  std::ifstream file(entry_path(folder, key), std::ios::binary);
  EntryHeader header;
  if (!file.read(reinterpret_cast<char*>(&header), sizeof(header))) return std::nullopt;
  const EntryHeader expected;
  if (header.magic != expected.magic || header.version != expected.version || header.words > words_max)
    return std::nullopt;
  std::vector<std::uint32_t> words(header.words);
  if (!file.read(reinterpret_cast<char*>(words.data()),
                 static_cast<std::streamsize>(words.size() * sizeof(std::uint32_t))))
    return std::nullopt;
  if (file.peek() != std::ifstream::traits_type::eof() || checksum(words) != header.checksum)
    return std::nullopt;
  return words;
}

bool write_cache_entry(const std::filesystem::path& folder, const std::string& key,
                       std::span<const std::uint32_t> spirv) {
  static std::atomic<unsigned> counter{0};
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path aside = folder / fmt::format("{}.{}.{}.tmp", key, getpid(), counter++);
  {
    std::ofstream file(aside, std::ios::binary | std::ios::trunc);
    EntryHeader header;
    header.words = spirv.size();
    header.checksum = checksum(spirv);
    file.write(reinterpret_cast<const char*>(&header), sizeof(header));
    file.write(reinterpret_cast<const char*>(spirv.data()), static_cast<std::streamsize>(spirv.size_bytes()));
    file.close();
    if (!file) {
      std::filesystem::remove(aside, error);
      return false;
    }
  }
  std::filesystem::rename(aside, entry_path(folder, key), error);
  if (!error) return true;
  std::filesystem::remove(aside, error);
  return false;
}

}  // namespace brace::gpu
