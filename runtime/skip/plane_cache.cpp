#include "runtime/skip/plane_cache.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <system_error>

#include <unistd.h>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::array<char, 8> magic = {'b', 'r', 'a', 'c', 'e', 's', 'k', '1'};

/// FNV-1a, 64 bits, twice with different starts.
class Hash {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      for (std::uint64_t& half : halves_)
        half = (half ^ std::to_integer<std::uint64_t>(byte)) * 1099511628211ull;
      halves_[1] ^= halves_[1] >> 29;
    }
  }
  template <typename T>
  void add_values(std::span<const T> values) {
    add(std::as_bytes(values));
  }
  std::string text() const { return fmt::format("{:016x}{:016x}", halves_[0], halves_[1]); }
  std::uint64_t first() const { return halves_[0]; }

 private:
  std::array<std::uint64_t, 2> halves_ = {14695981039346656037ull, 11400714819323198485ull};
};

std::filesystem::path file_for(const std::filesystem::path& folder, const std::string& key) {
  return folder / (key + ".planes");
}

}  // namespace

std::string plane_cache_key(SkipKernels& kernels, const VolumeOnDevice& volume, const BlockGrid& grid,
                            const Partitioning& partitioning, Occupancy occupancy) {
  const gpu::Device& device = kernels.device();
  const VolumeInfo& info = volume.info();
  const VolumeReader reader(device, volume, grid, occupancy);
  const auto rows = static_cast<std::uint32_t>(info.dims[1]) * static_cast<std::uint32_t>(info.dims[2]);
  const gpu::Buffer hashes(device, "row hashes", std::uint64_t{rows} * 8, gpu::Memory::readback);
  gpu::CommandList commands(device, "skip hash");
  commands.dispatch(kernels.get("hash", reader.defines()),
                    {reader.params(), reader.volume(),
                     bind_range(device, 2, hashes, 0, hashes.size_bytes(), "a hash of each row")},
                    gpu::push_bytes(rows), linear_groups(rows, 64));
  commands.barrier();
  gpu::submit_and_wait(commands);
  std::vector<std::uint32_t> values(std::size_t{rows} * 2);
  gpu::download_values(device, hashes, std::span<std::uint32_t>(values));
  Hash hash;
  hash.add_values(std::span<const std::uint32_t>(values));
  hash.add_values(std::span<const int>(info.dims));
  const std::array<int, 3> made_with = {static_cast<int>(info.type), grid.edge, static_cast<int>(occupancy)};
  hash.add_values(std::span<const int>(made_with));
  hash.add_values(std::span<const std::uint32_t>(partitioning.first_key));
  return hash.text();
}

std::optional<std::vector<std::byte>> read_plane_cache(const std::filesystem::path& folder,
                                                       const std::string& key, std::uint64_t size_bytes) {
  const auto path = file_for(folder, key);
  std::error_code error;
  const std::uint64_t expected = magic.size() + sizeof(std::uint64_t) + size_bytes;
  if (std::filesystem::file_size(path, error) != expected || error) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> head{};
  std::uint64_t check = 0;
  std::vector<std::byte> bytes(size_bytes);
  file.read(head.data(), head.size());
  file.read(reinterpret_cast<char*>(&check), sizeof(check));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file || head != magic) return std::nullopt;
  Hash hash;
  hash.add(bytes);
  if (hash.first() != check) return std::nullopt;
  return bytes;
}

void write_plane_cache(const std::filesystem::path& folder, const std::string& key,
                       std::span<const std::byte> bytes) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const auto path = file_for(folder, key);
  auto part = path;
  part += fmt::format(".{}.part", ::getpid());
  Hash hash;
  hash.add(bytes);
  const std::uint64_t check = hash.first();
  {
    std::ofstream file(part, std::ios::binary);
    file.write(magic.data(), magic.size());
    file.write(reinterpret_cast<const char*>(&check), sizeof(check));
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.flush();
    if (!file) {
      file.close();
      std::filesystem::remove(part, error);
      throw input_error(
          "{}: the skip structures' cache cannot be written (accepted: a writable folder with {} bytes "
          "of room)",
          folder.string(), bytes.size());
    }
  }
  std::filesystem::rename(part, path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw input_error("{}: {}", path.string(), error.message());
  }
}

BitPlanes cached_planes(SkipKernels& kernels, const SkipScene& scene, const BlockGrid& grid,
                        const Partitioning& partitioning, const SkipOptions& options,
                        const Progress& progress) {
  const auto build = [&] {
    return BitPlanes(kernels, scene.volume, grid, partitioning, options.occupancy, progress);
  };
  if (options.cache_folder.empty()) return build();
  const std::string key = plane_cache_key(kernels, scene.volume, grid, partitioning, options.occupancy);
  const std::uint64_t size_bytes = BitPlanes::bytes_for(grid, partitioning.count());
  if (const auto kept = read_plane_cache(options.cache_folder, key, size_bytes)) {
    if (progress) progress(1.0);
    return BitPlanes(kernels.device(), grid, partitioning.count(), *kept);
  }
  BitPlanes planes = build();
  std::vector<std::byte> bytes(size_bytes);
  gpu::download(kernels.device(), planes.buffer(), bytes);
  write_plane_cache(options.cache_folder, key, bytes);
  return planes;
}

}  // namespace brace
