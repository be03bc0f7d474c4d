// The entry of libFuzzer; FUZZ_TARGET names the reader.
#include <cstdlib>

#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const brace::fuzz::Target* const target = [] {
    for (const brace::fuzz::Target& one : brace::fuzz::targets()) {
      if (one.name == FUZZ_TARGET) return &one;
    }
    std::abort();
  }();
  brace::fuzz::run(*target, {data, size});
  return 0;
}
