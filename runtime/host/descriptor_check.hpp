#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plugins/abi/brace_stage.h"

namespace brace {

// Inside runtime/host only: from a library's structs, which may be shorter or longer than this host's, to
// this host's own. `place` ("libx.so: stage 2 'mip'") starts the messages; all throw device_error.

/// Sizes of the structs in ABI 1.0, the smallest that a library of major version 1 can state.
struct AbiSizes {
  static constexpr std::size_t descriptor = 96, param = 72;
  static constexpr std::size_t rays = 24, cast = 24, skip = 32, other = 16;
};

/// The fields that both know; the rest is zero.
brace_stage_descriptor own_descriptor(const brace_stage_descriptor* from, const std::string& place);
std::vector<brace_param> own_params(const brace_stage_descriptor& descriptor, const std::string& place);
/// The kind's table, in the size of this host's struct.
std::vector<std::byte> own_functions(const brace_stage_descriptor& descriptor, const std::string& place);

/// What every descriptor must have, whatever it came from.
void check_descriptor(const brace_stage_descriptor& descriptor, const std::string& place);

}  // namespace brace
