#pragma once

#include <cstdint>

namespace brace {

/// Calls of operator new in this program so far (all forms; the program's own are replaced).
std::uint64_t allocation_count();

}  // namespace brace
