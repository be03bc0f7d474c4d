#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace brace {

/// A file being written, buffered; owns its descriptor. Every failed write throws brace::Error at once, with
/// what to do: a full disk is exit code 3, a path that cannot be written is exit code 2.
class OutputFile {
 public:
  /// Creates the file, or empties it.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();  // closes; what is still buffered is dropped
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;

  void write(std::string_view bytes);
  /// Writes what is buffered and flushes it to the disk.
  void close();

 private:
  void flush();

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::string buffer_;
};

/// Throws for a failed file operation: `what` as in "cannot write", and the errno it failed with.
[[noreturn]] void throw_file_error(const std::filesystem::path& path, std::string_view what,
                                   int error_number);

}  // namespace brace
