#include "runtime/skip/choose_skip.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "base/error.hpp"
#include "runtime/skip/structures.hpp"

namespace brace {

namespace {

SkipOptions options_of(SkipKind kind, int partitions, RangeMinima minima = RangeMinima::none) {
  SkipOptions options;
  options.kind = kind;
  options.partitions = partitions;
  options.range_minima = minima;
  // Borders where the transfer functions in use turn: else the empty space shares a partition with what
  // shows.
  options.placement = Partitions::adaptive;
  return options;
}

/// Partitions enough that the borders of the table's visible runs can be told apart: a power of two, 16 … 64.
int partitions_for(const SkipQuestion& question) {
  const auto& entries = question.table.entries;
  int changes = 0;
  for (std::size_t i = 1; i < entries.size(); ++i)
    changes += (entries[i][3] > 0.0) != (entries[i - 1][3] > 0.0);
  int partitions = 16;
  while (partitions < 64 && partitions < 16 * changes)
    partitions *= 2;
  return partitions;
}

}  // namespace

SkipChoice choose_skip(const SkipQuestion& question) {
  const std::string share = fmt::format("{:.1f} % of the blocks are occupied", 100.0 * question.occupied);
  if (question.occupied >= occupancy_worth_skipping) {
    return {options_of(SkipKind::none, 1),
            fmt::format("none: {}, from {:.0f} % on a look-up costs more than the samples it saves", share,
                        100.0 * occupancy_worth_skipping)};
  }
  const int n = partitions_for(question);
  struct Candidate {
    SkipOptions options;
    const char* why;
  };
  const std::vector<Candidate> if_it_stays = {
      {options_of(SkipKind::distance_map, 1), "nothing is kept for its changes"}};
  const std::vector<Candidate> if_it_changes = {
      {options_of(SkipKind::partitioned, n, RangeMinima::segment_tree),
       "a change merges a few maps, whatever n"},
      {options_of(SkipKind::partitioned, n), "a change merges the visible maps"},
      {options_of(SkipKind::bitmask, n), "an eighth of the memory, a change computes distances"},
      {options_of(SkipKind::distance_map, 1), "least memory, a change reads the volume"}};
  for (const Candidate& candidate : question.table_changes ? if_it_changes : if_it_stays) {
    const SkipMemory memory = skip_memory(question.volume, candidate.options);
    const std::uint64_t bytes = memory.kept_bytes + memory.scratch_bytes;
    if (question.memory_bytes_max > 0 && bytes > question.memory_bytes_max) continue;
    return {
        candidate.options,
        fmt::format("{}: {} and the transfer function {}: {} ({}{:.1f} MB)",
                    to_string(candidate.options.kind), share, question.table_changes ? "changes" : "stays",
                    candidate.why, candidate.options.partitions > 1 ? fmt::format("{} partitions, ", n) : "",
                    static_cast<double>(bytes) * 1e-6)};
  }
  return {options_of(SkipKind::none, 1),
          fmt::format("none: no structure fits {} MB", question.memory_bytes_max / 1'000'000)};
}

double occupied_blocks(SkipKernels& kernels, const SkipScene& scene, const TransferTable& table,
                       int block_voxels) {
  const gpu::Device& device = kernels.device();
  const BlockGrid grid(scene.volume.info(), block_voxels);
  const VolumeReader reader(device, scene.volume, grid, Occupancy::cell);
  VisibleKeys visible(device, scene.volume.info().type);
  visible.set(device, Visibility(table, interpolation_slack(scene.volume, scene.statistics.range)));
  const BitPlane plane(device, grid, "occupied blocks");
  gpu::CommandList commands(device, "count of occupied blocks");
  record_occupancy(commands, kernels, grid, reader, visible, plane);
  gpu::submit_and_wait(commands);
  std::vector<std::uint32_t> words(grid.plane_words());
  gpu::download_values(device, plane.buffer, std::span<std::uint32_t>(words));
  std::uint64_t occupied = 0;
  for (const std::uint32_t word : words)
    occupied += static_cast<std::uint64_t>(std::popcount(word));
  return static_cast<double>(occupied) / static_cast<double>(grid.count());
}

}  // namespace brace
