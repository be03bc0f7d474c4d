#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/volume/stored_volume.hpp"

namespace brace {

// Line-by-line reading of the text headers (NRRD, MetaImage).

/// Walks through a header's lines ("\n" or "\r\n"); remembers where it is for messages.
class HeaderLines {
 public:
  /// Reads the file's first 1 MiB, the longest header accepted.
  explicit HeaderLines(const std::filesystem::path& path);

  /// The next line without its end, or nothing at the end of the text.
  std::optional<std::string_view> next();

  std::size_t offset_bytes() const { return offset_; }  // of what follows the last line read
  std::string place() const;                            // "file:line"
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::string text_;
  std::size_t offset_ = 0;
  int line_ = 0;
};

std::string_view trimmed(std::string_view text);
std::string lowered(std::string_view text);
std::vector<std::string_view> words(std::string_view text);  // separated by blanks

/// Whole-text numbers, independent of the locale; throw brace::Error naming `where` and the text.
std::int64_t parse_integer(std::string_view text, const std::string& where);
double parse_number(std::string_view text, const std::string& where);

/// The files a header may name as its data: one regular file, beside the header unless absolute.
std::filesystem::path data_file_beside(const std::filesystem::path& header, std::string_view name);

/// "uint8", "int16", ... as this program names them; nothing for another word.
std::optional<StoredType> stored_type_of(std::string_view name);

}  // namespace brace
