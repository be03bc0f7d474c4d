#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/gpu/shader_compiler.hpp"

namespace brace::gpu {

// Inside runtime/gpu only: the files of a kernel, before it is compiled.

/// Every source that a kernel can include, whether or not the preprocessor gets there.
struct IncludeClosure {
  std::map<std::string, GlslSource, std::less<>> found;  // by include name
  std::vector<std::string> order;                        // names of the sources, main first
};

/// Follows #include lines with the kernel's resolver. Includes that nothing resolves are left out: the
/// compiler complains where they are needed.
IncludeClosure find_includes(const KernelDescription& kernel);

/// A content hash (128 bits, hexadecimal) of everything that decides the SPIR-V: text and names of the
/// sources, defines, `compiler` (version and settings).
std::string content_key(const KernelDescription& kernel, const IncludeClosure& includes,
                        std::string_view compiler);

}  // namespace brace::gpu
