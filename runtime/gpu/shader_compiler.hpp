#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace brace::gpu {

/// A piece of GLSL. `name` is what error messages call it (a path, or stage/family/name.glsl).
struct GlslSource {
  std::string name;
  std::string text;
};

/// Finds what #include "name" or <name> means; nullopt: not known.
using IncludeResolver = std::function<std::optional<GlslSource>(std::string_view include_name)>;

/// The value of a specialisation constant: `layout(constant_id = id) const float x = …;`. Stage parameters
/// reach a kernel this way.
struct SpecConstant {
  std::uint32_t id = 0;
  std::uint32_t bits = 0;  // the 4 bytes of a float, int or uint; 0 or 1 for a bool
  bool operator==(const SpecConstant&) const = default;
};

inline SpecConstant spec_constant(std::uint32_t id, float value) {
  return {id, std::bit_cast<std::uint32_t>(value)};
}
inline SpecConstant spec_constant(std::uint32_t id, std::int32_t value) {
  return {id, std::bit_cast<std::uint32_t>(value)};
}
inline SpecConstant spec_constant(std::uint32_t id, std::uint32_t value) {
  return {id, value};
}
inline SpecConstant spec_constant(std::uint32_t id, bool value) {
  return {id, value ? 1u : 0u};
}

/// A compute kernel in GLSL: the main text starts with #version. Includes nest; a file includes another
/// through GL_GOOGLE_include_directive or GL_ARB_shading_language_include, which compile() switches on.
struct KernelDescription {
  GlslSource main;
  IncludeResolver resolve;                                   // may be empty
  std::vector<std::pair<std::string, std::string>> defines;  // name, value
  std::vector<SpecConstant> constants;                       // used by make_pipeline, not by compile
};

struct CompileOptions {
  bool use_cache = true;
  /// "" for the default: $XDG_CACHE_HOME/brace/spirv, else ~/.cache/brace/spirv; no cache when neither is
  /// set.
  std::filesystem::path cache_folder;
};

struct CompiledKernel {
  std::vector<std::uint32_t> spirv;
  bool cache_hit = false;
  std::vector<std::string> sources;  // names of the main source and of every include, in order of first use
};

/// Compiles for Vulkan 1.3 and drops bindings that nothing uses. The cache is keyed by the content of
/// everything that goes in; a broken or foreign entry counts as a miss. Throws input_error with
/// "name:line: message" lines, where name is the included source's and line its own.
CompiledKernel compile(const KernelDescription& kernel, const CompileOptions& options = {});

/// The key of the cache: a hash of the text of everything that goes in, 32 hexadecimal digits.
std::string kernel_key(const KernelDescription& kernel);

std::filesystem::path default_cache_folder();

/// Looks `name` up in the folders in order. Names with ".." or an absolute path are not found.
IncludeResolver directory_resolver(std::vector<std::filesystem::path> folders);
/// Asks the resolvers in order.
IncludeResolver chain_resolvers(std::vector<IncludeResolver> resolvers);
/// Reads a GLSL file; throws input_error when it cannot be read. `name` defaults to the path's file name.
GlslSource read_glsl(const std::filesystem::path& path, std::string name = "");

}  // namespace brace::gpu
