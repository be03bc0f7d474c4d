#pragma once

#include <cstdint>

namespace brace {

/// What this thread has done with malloc and free since it started; C, C++ and every shared library alike. A
/// program that links this replaces malloc by a counting one (a few instructions per call); under
/// AddressSanitizer its own hooks are used.
struct AllocationCount {
  std::uint64_t allocations = 0;
  std::uint64_t frees = 0;

  std::int64_t living() const { return static_cast<std::int64_t>(allocations - frees); }
};

AllocationCount allocations_of_this_thread();

}  // namespace brace
