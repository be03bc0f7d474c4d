#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

namespace brace {

/// A folder of its own per test, removed at the end.
class FolderTest : public testing::Test {
 protected:
  FolderTest();
  ~FolderTest() override;
  std::filesystem::path write(const std::string& name, std::string_view bytes) const;
  std::filesystem::path folder;
};

template <typename T>
std::string bytes_of(const std::vector<T>& values, bool big_endian = false) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  if (big_endian)
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(T))
      for (std::size_t j = 0; j < sizeof(T) / 2; ++j)
        std::swap(bytes[i + j], bytes[i + sizeof(T) - 1 - j]);
  return bytes;
}

std::string gzipped(std::string_view bytes);
std::string zlib_compressed(std::string_view bytes);

Volume load(const std::string& path_or_generator, const OpenOptions& options = {});
std::vector<double> values_of(const Volume& volume);

/// The message of the brace::Error that opening and reading the volume throws, which must have exit code 2.
std::string error_of(const std::string& path_or_generator, const OpenOptions& options = {});

std::filesystem::path preset_folder();

/// Folder with the real data, or an empty path.
std::filesystem::path shared_volumes();

/// Largest single allocation since the last reset.
void reset_largest_allocation();
std::size_t largest_allocation_bytes();

}  // namespace brace
