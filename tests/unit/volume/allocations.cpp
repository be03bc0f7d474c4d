#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/unit/volume/support.hpp"

// Every allocation of this program passes here, so that tests can say how large the largest one was.

namespace {

std::atomic<std::size_t> largest_bytes{0};

void* counted(std::size_t bytes) {
  std::size_t known = largest_bytes.load();
  while (bytes > known && !largest_bytes.compare_exchange_weak(known, bytes)) {
  }
  void* memory = std::malloc(std::max<std::size_t>(bytes, 1));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
  return counted(bytes);
}
void* operator new[](std::size_t bytes) {
  return counted(bytes);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace brace {

void reset_largest_allocation() {
  largest_bytes = 0;
}
std::size_t largest_allocation_bytes() {
  return largest_bytes;
}

}  // namespace brace
