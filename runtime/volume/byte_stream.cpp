#include "runtime/volume/byte_stream.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <vector>

#include <zlib.h>

#include "base/error.hpp"

namespace brace {
namespace {

class FileStream : public ByteStream {
 public:
  FileStream(const std::filesystem::path& path, std::uint64_t offset_bytes)
      : path_(path), file_(path, std::ios::binary) {
    if (!file_) throw input_error("{}: cannot be opened: {}", path.string(), std::strerror(errno));
    file_.seekg(static_cast<std::streamoff>(offset_bytes));
  }

  std::size_t read(std::span<std::byte> out) override {
    file_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    if (file_.bad()) throw input_error("{}: reading failed: {}", path_.string(), std::strerror(errno));
    return static_cast<std::size_t>(file_.gcount());
  }

 private:
  std::filesystem::path path_;
  std::ifstream file_;
};

class InflateStream : public ByteStream {
 public:
  InflateStream(const std::filesystem::path& path, std::uint64_t offset_bytes)
      : path_(path), file_(path, offset_bytes), input_(std::size_t{1} << 18) {
    constexpr int largest_window = 15;
    constexpr int detect_gzip_or_zlib = 32;
    if (inflateInit2(&zlib_, largest_window + detect_gzip_or_zlib) != Z_OK)
      throw input_error("{}: zlib cannot start: {}", path_.string(), message());
  }

  ~InflateStream() override { inflateEnd(&zlib_); }
  InflateStream(const InflateStream&) = delete;
  InflateStream& operator=(const InflateStream&) = delete;

  std::size_t read(std::span<std::byte> out) override {
    std::size_t done = 0;
    while (done < out.size() && !ended_) {
      if (zlib_.avail_in == 0 && !refill()) break;
      done += inflate_into(out.subspan(done));
    }
    return done;
  }

 private:
  const char* message() const { return zlib_.msg != nullptr ? zlib_.msg : "no further reason given"; }

  bool refill() {
    const std::size_t count = file_.read(input_);
    zlib_.next_in = reinterpret_cast<Bytef*>(input_.data());
    zlib_.avail_in = static_cast<uInt>(count);
    return count > 0;
  }

  std::size_t inflate_into(std::span<std::byte> out) {
    const std::size_t room = std::min<std::size_t>(out.size(), std::numeric_limits<uInt>::max());
    zlib_.next_out = reinterpret_cast<Bytef*>(out.data());
    zlib_.avail_out = static_cast<uInt>(room);
    const int status = inflate(&zlib_, Z_NO_FLUSH);
    if (status == Z_STREAM_END) {
      start_next_member();
    } else if (status != Z_OK && status != Z_BUF_ERROR) {
      throw input_error("{}: the compressed data is damaged: {} (accepted: gzip or zlib)", path_.string(),
                        message());
    }
    return room - zlib_.avail_out;
  }

  /// Another gzip member may follow; anything else behind a stream is padding and not read.
  void start_next_member() {
    if (zlib_.avail_in == 0) refill();
    const bool another = zlib_.avail_in > 1 && zlib_.next_in[0] == 0x1f && zlib_.next_in[1] == 0x8b;
    if (another) {
      inflateReset(&zlib_);
    } else {
      ended_ = true;
    }
  }

  std::filesystem::path path_;
  FileStream file_;
  std::vector<std::byte> input_;
  z_stream zlib_{};
  bool ended_ = false;
};

}  // namespace

std::uint64_t regular_file_size(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw input_error("{}: there is no such file", path.string());
  if (!std::filesystem::is_regular_file(status))
    throw input_error("{}: is not a regular file", path.string());
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw input_error("{}: {}", path.string(), error.message());
  return size;
}

std::unique_ptr<ByteStream> open_file_stream(const std::filesystem::path& path, std::uint64_t offset_bytes) {
  return std::make_unique<FileStream>(path, offset_bytes);
}

std::unique_ptr<ByteStream> open_inflate_stream(const std::filesystem::path& path,
                                                std::uint64_t offset_bytes) {
  return std::make_unique<InflateStream>(path, offset_bytes);
}

std::uint64_t max_inflated_bytes(std::uint64_t deflated_bytes) {
  constexpr std::uint64_t largest_ratio = 1032;
  constexpr std::uint64_t rounding = 1032;
  return deflated_bytes * largest_ratio + rounding;
}

std::uint64_t skip_bytes(ByteStream& stream, std::uint64_t count) {
  std::array<std::byte, 16384> dropped;
  std::uint64_t done = 0;
  while (done < count) {
    const std::size_t wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(count - done, dropped.size()));
    const std::size_t got = stream.read(std::span(dropped).first(wanted));
    done += got;
    if (got < wanted) break;
  }
  return done;
}

}  // namespace brace
