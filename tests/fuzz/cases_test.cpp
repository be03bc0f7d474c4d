// Inputs that once broke a reader, and seeds of every kind: none breaks one again.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/fuzz/targets.hpp"

namespace brace::fuzz {
namespace {

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Fuzz, EveryKeptCaseIsReadOrRefused) {
  int cases = 0;
  for (const Target& target : targets()) {
    const std::filesystem::path folder =
        std::filesystem::path(BRACE_SOURCE_DIR) / "tests/fuzz/cases" / target.name;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      SCOPED_TRACE(entry.path().string());
      const std::vector<std::uint8_t> bytes = bytes_of(entry.path());
      EXPECT_NO_THROW(run(target, bytes));
      // Cut short and with a byte changed, as files are in life.
      EXPECT_NO_THROW(run(target, std::span(bytes).first(bytes.size() / 2)));
      std::vector<std::uint8_t> changed = bytes;
      for (std::size_t i = 0; i < changed.size(); i += 7)
        changed[i] = static_cast<std::uint8_t>(changed[i] + 13);
      EXPECT_NO_THROW(run(target, changed));
      ++cases;
    }
  }
  EXPECT_GE(cases, 10);
}

}  // namespace
}  // namespace brace::fuzz
