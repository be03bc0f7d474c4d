#include "runtime/report/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::size_t buffer_bytes = 1 << 16;

}  // namespace

void throw_file_error(const std::filesystem::path& path, std::string_view what, int error_number) {
  const char* reason = std::strerror(error_number);
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      throw device_error("{}: {}: {}; free some space or choose another folder with --out", path.string(),
                         what, reason);
    case EIO:
      throw device_error("{}: {}: {}; the disk failed, choose another folder with --out", path.string(), what,
                         reason);
    default:
      throw input_error("{}: {}: {}; choose a folder you may write to with --out", path.string(), what,
                        reason);
  }
}

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw_file_error(path_, "cannot create the file", errno);
  buffer_.reserve(buffer_bytes);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      buffer_(std::move(other.buffer_)) {}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::string_view part = bytes.substr(0, buffer_bytes - buffer_.size());
    buffer_ += part;
    bytes.remove_prefix(part.size());
    if (buffer_.size() == buffer_bytes) flush();
  }
}

void OutputFile::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      throw_file_error(path_, "cannot write", errno);
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  buffer_.clear();
}

void OutputFile::close() {
  BRACE_CHECK(descriptor_ >= 0);
  flush();
  // Some file systems tell of a full disk only here. Those that cannot flush (EINVAL: a pipe) need not.
  if (::fsync(descriptor_) != 0 && errno != EINVAL) throw_file_error(path_, "cannot write", errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) throw_file_error(path_, "cannot write", errno);
}

}  // namespace brace
