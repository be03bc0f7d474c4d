#include "runtime/host/allocation_count.hpp"

#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__)
#define BRACE_HOOKS_OF_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define BRACE_HOOKS_OF_SANITIZER
#endif
#endif

namespace brace {

namespace {

// Initial-exec: reached without a call that could itself allocate.
__attribute__((tls_model("initial-exec"))) thread_local AllocationCount counted;

void count_allocation(const void* block) {
  if (block != nullptr) ++counted.allocations;
}
void count_free(const void* block) {
  if (block != nullptr) ++counted.frees;
}

}  // namespace

#if defined(BRACE_HOOKS_OF_SANITIZER)

extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             std::size_t),
                                                         void (*free_hook)(const volatile void*));

AllocationCount allocations_of_this_thread() {
  static const int installed = __sanitizer_install_malloc_and_free_hooks(
      [](const volatile void* block, std::size_t) { count_allocation(const_cast<const void*>(block)); },
      [](const volatile void* block) { count_free(const_cast<const void*>(block)); });
  static_cast<void>(installed);
  return counted;
}

#else

AllocationCount allocations_of_this_thread() {
  return counted;
}

#endif

}  // namespace brace

#if !defined(BRACE_HOOKS_OF_SANITIZER)

// The C library's own functions under the names it keeps for this purpose. A program's definitions go before
// those of every shared library.
extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  void* block = __libc_malloc(size);
  brace::count_allocation(block);
  return block;
}

void* calloc(std::size_t count, std::size_t size) {
  void* block = __libc_calloc(count, size);
  brace::count_allocation(block);
  return block;
}

void* realloc(void* block, std::size_t size) {
  void* moved = __libc_realloc(block, size);
  if (moved != nullptr || size == 0) brace::count_free(block);
  brace::count_allocation(moved);
  return moved;
}

void* memalign(std::size_t alignment, std::size_t size) {
  void* block = __libc_memalign(alignment, size);
  brace::count_allocation(block);
  return block;
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return memalign(alignment, size);
}

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  void* block = memalign(alignment, size);
  if (block == nullptr) return ENOMEM;
  *out = block;
  return 0;
}

void free(void* block) {
  brace::count_free(block);
  __libc_free(block);
}

}  // extern "C"

#endif
