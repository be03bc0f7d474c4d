#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace brace::fuzz {

/// A reader of what users bring. It gets any bytes and may refuse them with brace::Error; everything else (a
/// crash, a hang, another exception, a sanitizer's message) is a defect.
struct Target {
  std::string name;  // also the folder of its cases
  void (*read)(std::span<const std::uint8_t> bytes);
};

const std::vector<Target>& targets();

/// Runs a target; other exceptions than brace::Error leave it.
void run(const Target& target, std::span<const std::uint8_t> bytes);

}  // namespace brace::fuzz
