#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace brace {

/// Bytes of a file, forward only.
class ByteStream {
 public:
  virtual ~ByteStream() = default;

  /// Fills as much of `out` as there is left and returns how much; less than out.size() only at the end.
  /// Throws brace::Error (exit code 2) where a compressed stream is damaged or the disk fails.
  virtual std::size_t read(std::span<std::byte> out) = 0;
};

/// Size of a regular file; throws brace::Error (exit code 2) if there is none at `path`, naming it.
std::uint64_t regular_file_size(const std::filesystem::path& path);

std::unique_ptr<ByteStream> open_file_stream(const std::filesystem::path& path, std::uint64_t offset_bytes);

/// A gzip or zlib stream (told apart by its header; several gzip members in a row count as one) that begins
/// `offset_bytes` into the file. Never takes more memory than a fixed buffer.
std::unique_ptr<ByteStream> open_inflate_stream(const std::filesystem::path& path,
                                                std::uint64_t offset_bytes);

/// No deflate stream of n bytes yields more than 1032 n (zlib's documentation), plus what rounding needs.
std::uint64_t max_inflated_bytes(std::uint64_t deflated_bytes);

/// Reads and drops up to `count` bytes; returns how many there were.
std::uint64_t skip_bytes(ByteStream& stream, std::uint64_t count);

}  // namespace brace
