#pragma once

#include <cstdint>
#include <span>

#include "runtime/gpu/commands.hpp"
#include "runtime/skip/skip_kernels.hpp"

namespace brace {

enum class MergeKind {
  smallest_byte,  // of distance maps: the minimum
  any_bit         // of bit planes: the union
};

/// Maps or planes to merge: pieces of a texel buffer of 16 bytes a texel.
struct MergeSources {
  const gpu::TexelBuffer& quads;
  std::span<const std::uint32_t> first_quads;  // of each; at least one
  std::uint32_t count_quads = 0;               // of every one
};

/// Records target = merged sources, and with `onto` what was there already, with a barrier after each pass of
/// at most 16 sources. Bytes read and written.
std::uint64_t record_merge(gpu::CommandList& commands, SkipKernels& kernels, MergeKind kind,
                           const MergeSources& sources, const gpu::Binding& target, bool onto = false);

/// Runs every kernel that record_merge may use once, on nothing, so that no merge waits for a compiler.
void warm_merges(SkipKernels& kernels, MergeKind kind, const gpu::TexelBuffer& quads,
                 const gpu::Binding& target);

}  // namespace brace
