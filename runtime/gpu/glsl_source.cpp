#include "runtime/gpu/glsl_source.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/core.h>

#include "base/error.hpp"

namespace brace::gpu {
namespace {

constexpr std::string_view blanks = " \t";

std::string_view skip_blanks(std::string_view text) {
  const std::size_t at = text.find_first_not_of(blanks);
  return at == std::string_view::npos ? std::string_view() : text.substr(at);
}

// The name in `#include "name"` or <name>; empty for any other line.
std::string_view included_name(std::string_view line) {
  line = skip_blanks(line);
  if (!line.starts_with('#')) return {};
  line = skip_blanks(line.substr(1));
  constexpr std::string_view keyword = "include";
  if (!line.starts_with(keyword)) return {};
  line = skip_blanks(line.substr(keyword.size()));
  if (line.empty() || (line[0] != '"' && line[0] != '<')) return {};
  const std::size_t end = line.find(line[0] == '"' ? '"' : '>', 1);
  return end == std::string_view::npos ? std::string_view() : line.substr(1, end - 1);
}

void follow_includes(const KernelDescription& kernel, const GlslSource& source, IncludeClosure& closure) {
  closure.order.push_back(source.name);
  for (std::size_t at = 0; at < source.text.size();) {
    const std::size_t end = std::min(source.text.find('\n', at), source.text.size());
    const std::string_view name = included_name(std::string_view(source.text).substr(at, end - at));
    at = end + 1;
    if (name.empty() || !kernel.resolve || closure.found.contains(name)) continue;
    std::optional<GlslSource> included = kernel.resolve(name);
    if (!included) continue;
    const auto entry = closure.found.emplace(std::string(name), std::move(*included)).first;
    follow_includes(kernel, entry->second, closure);
  }
}

// FNV-1a with 128 bits. Lengths go in too, so that neighbouring fields cannot run into each other.
class Fnv128 {
 public:
  void add(std::string_view text) {
    add_bytes(text);
    add_bytes(fmt::format("#{};", text.size()));
  }
  std::string hex() const {
    return fmt::format("{:016x}{:016x}", static_cast<std::uint64_t>(state_ >> 64),
                       static_cast<std::uint64_t>(state_));
  }

 private:
  __extension__ using Uint128 = unsigned __int128;
  void add_bytes(std::string_view text) {
    for (const char c : text)
      state_ = (state_ ^ static_cast<unsigned char>(c)) * prime;
  }
  static constexpr Uint128 prime = (Uint128{0x1000000} << 64) | 0x13b;
  Uint128 state_ = (Uint128{0x6c62272e07bb0142} << 64) | 0x62b821756295c58d;
};

}  // namespace

IncludeClosure find_includes(const KernelDescription& kernel) {
  IncludeClosure closure;
  follow_includes(kernel, kernel.main, closure);
  return closure;
}

std::string content_key(const KernelDescription& kernel, const IncludeClosure& includes,
                        std::string_view compiler) {
  Fnv128 hash;
  hash.add(compiler);
  hash.add(kernel.main.name);
  hash.add(kernel.main.text);
  for (const auto& [name, source] : includes.found) {
    hash.add(name);
    hash.add(source.name);
    hash.add(source.text);
  }
  for (const auto& [name, value] : kernel.defines) {
    hash.add(name);
    hash.add(value);
  }
  return hash.hex();
}

GlslSource read_glsl(const std::filesystem::path& path, std::string name) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size_bytes = std::filesystem::file_size(path, error);
  std::string text(error ? 0 : size_bytes, '\0');
  if (error || !file.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw input_error("{}: cannot read this GLSL file", path.string());
  return {name.empty() ? path.filename().string() : std::move(name), std::move(text)};
}

IncludeResolver directory_resolver(std::vector<std::filesystem::path> folders) {
  return [folders = std::move(folders)](std::string_view name) -> std::optional<GlslSource> {
    const std::filesystem::path relative(name);
    if (relative.is_absolute() || std::find(relative.begin(), relative.end(), "..") != relative.end())
      return std::nullopt;
    for (const std::filesystem::path& folder : folders)
      if (std::filesystem::is_regular_file(folder / relative))
        return read_glsl(folder / relative, std::string(name));
    return std::nullopt;
  };
}

IncludeResolver chain_resolvers(std::vector<IncludeResolver> resolvers) {
  return [resolvers = std::move(resolvers)](std::string_view name) -> std::optional<GlslSource> {
    for (const IncludeResolver& resolve : resolvers)
      if (std::optional<GlslSource> source = resolve(name)) return source;
    return std::nullopt;
  };
}

}  // namespace brace::gpu
