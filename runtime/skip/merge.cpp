#include "runtime/skip/merge.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/error.hpp"

namespace brace {

namespace {

/// Sources of a pass; a pass of fewer names its last one again.
constexpr std::array<std::uint32_t, 7> pass_sizes = {1, 2, 4, 6, 8, 12, 16};
constexpr std::uint32_t pass_max = pass_sizes.back();

/// Push constants of merge.comp; a kernel of fewer sources takes the first ones.
struct MergeParams {
  std::uint32_t quads, onto, first[pass_max];
};

std::span<const std::byte> push_part(const MergeParams& params, std::uint32_t size) {
  return gpu::push_bytes(params).first((2 + size) * sizeof(std::uint32_t));
}

const gpu::ComputePipeline& kernel(SkipKernels& kernels, MergeKind kind, std::uint32_t size) {
  Defines defines = {{"BRACE_MERGE_MAPS", std::to_string(size)}};
  if (kind == MergeKind::any_bit) defines.emplace_back("BRACE_MERGE_OR", "1");
  return kernels.get("merge", defines);
}

}  // namespace

std::uint64_t record_merge(gpu::CommandList& commands, SkipKernels& kernels, MergeKind kind,
                           const MergeSources& sources, const gpu::Binding& target, bool onto) {
  BRACE_CHECK(!sources.first_quads.empty());
  std::uint64_t moved = 0;  // sources and results, read or written
  for (std::span<const std::uint32_t> left = sources.first_quads; !left.empty();) {
    const auto taken = std::min(static_cast<std::uint32_t>(left.size()), pass_max);
    const std::uint32_t size = *std::lower_bound(pass_sizes.begin(), pass_sizes.end(), taken);
    MergeParams params{sources.count_quads, onto ? 1u : 0u, {}};
    std::fill(std::copy_n(left.begin(), taken, params.first), params.first + size, left[taken - 1]);
    commands.dispatch(kernel(kernels, kind, size), {gpu::bind(1, sources.quads), target},
                      push_part(params, size), linear_groups(sources.count_quads, 64));
    commands.barrier();
    moved += taken + 1 + params.onto;
    onto = true;
    left = left.subspan(taken);
  }
  return moved * sources.count_quads * 16;
}

void warm_merges(SkipKernels& kernels, MergeKind kind, const gpu::TexelBuffer& quads,
                 const gpu::Binding& target) {
  gpu::CommandList commands(kernels.device(), "warm-up of merges");
  const MergeParams nothing{};
  for (const std::uint32_t size : pass_sizes)
    commands.dispatch(kernel(kernels, kind, size), {gpu::bind(1, quads), target}, push_part(nothing, size),
                      {1, 1, 1});
  commands.barrier();
  gpu::submit_and_wait(commands);
}

}  // namespace brace
