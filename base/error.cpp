#include "base/error.hpp"

#include <cstdlib>

namespace brace {

void check_failed(const char* condition, const char* file, int line) {
  fmt::print(stderr, "brace: internal check failed: {} ({}:{})\n", condition, file, line);
  std::abort();
}

}  // namespace brace
