/* Compiled as C11 without extensions. brace_stage.h comes first: it stands alone. */
#include "brace_stage.h"
#include "layout_1_0.h"

_Static_assert(sizeof(struct BraceEyeParams) == 160, "the parameters of an eye in C");
_Static_assert(sizeof(struct BraceArea) == 16, "an area in C");

/* A frame's structs are filled field by field in C as well. */
uint32_t abi_c11_frame_size(void);
uint32_t abi_c11_frame_size(void) {
  const brace_cast_frame frame = {.struct_size = sizeof(brace_cast_frame), .eye = 1};
  return frame.struct_size * frame.eye;
}

uint32_t abi_c11_negotiate(uint32_t a_min, uint32_t a_max, uint32_t b_min, uint32_t b_max);
uint32_t abi_c11_negotiate(uint32_t a_min, uint32_t a_max, uint32_t b_min, uint32_t b_max) {
  return brace_negotiate_abi(a_min, a_max, b_min, b_max);
}
