// Compiled as C++20 without extensions. brace_stage.h comes first: it stands alone.
#include "brace_stage.h"
#include "layout_1_0.h"

// A type that crosses the interface is a plain C type.
#include <type_traits>
static_assert(std::is_trivial_v<brace_cast_frame> && std::is_standard_layout_v<brace_cast_frame>);
static_assert(std::is_trivial_v<brace_activation> && std::is_standard_layout_v<brace_activation>);
static_assert(std::is_trivial_v<brace_stage_descriptor> && std::is_standard_layout_v<brace_stage_descriptor>);

std::uint32_t abi_cxx20_frame_size();
std::uint32_t abi_cxx20_frame_size() {
  brace_cast_frame frame{};
  frame.struct_size = sizeof frame;
  frame.eye = 1;
  return frame.struct_size * frame.eye;
}
