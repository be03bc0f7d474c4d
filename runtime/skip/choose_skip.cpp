#include "runtime/skip/choose_skip.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"

namespace brace {

namespace {

SkipOptions options_of(SkipKind kind, int partitions, RangeMinima minima = RangeMinima::none) {
  SkipOptions options;
  options.kind = kind;
  options.partitions = partitions;
  options.range_minima = minima;
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
  const double visible = occupied_fraction(question.statistics, question.table);
  const std::string share = fmt::format("{:.1f} % of the voxels are visible", 100.0 * visible);
  if (!question.table_changes && visible >= occupancy_worth_skipping) {
    return {options_of(SkipKind::none, 1),
            fmt::format("none: {}, from {:.0f} % on a look-up costs more than the samples it saves", share,
                        100.0 * occupancy_worth_skipping)};
  }
  if (!question.table_changes) {
    return {
        options_of(SkipKind::distance_map, 1),
        fmt::format("distance_map: {} and the transfer function stays, so nothing is kept for its changes",
                    share)};
  }
  const int n = partitions_for(question);
  struct Candidate {
    SkipOptions options;
    const char* why;
  };
  const std::array<Candidate, 4> candidates = {{
      {options_of(SkipKind::partitioned, n, RangeMinima::segment_tree),
       "a change merges a few maps, whatever n"},
      {options_of(SkipKind::partitioned, n), "a change merges the visible maps"},
      {options_of(SkipKind::bitmask, n), "an eighth of the memory, a change computes distances"},
      {options_of(SkipKind::distance_map, 1), "least memory, a change reads the volume"},
  }};
  for (const Candidate& candidate : candidates) {
    const SkipMemory memory = skip_memory(question.volume, candidate.options);
    const std::uint64_t bytes = memory.kept_bytes + memory.scratch_bytes;
    if (question.memory_bytes_max > 0 && bytes > question.memory_bytes_max) continue;
    return {candidate.options,
            fmt::format("{}: {} and the transfer function changes: {} ({} partitions, {} MB)",
                        to_string(candidate.options.kind), share, candidate.why, candidate.options.partitions,
                        (bytes + 999'999) / 1'000'000)};
  }
  return {options_of(SkipKind::none, 1),
          fmt::format("none: no structure fits {} MB", question.memory_bytes_max / 1'000'000)};
}

}  // namespace brace
