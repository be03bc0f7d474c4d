#include <algorithm>
#include <bit>

#include "base/error.hpp"
#include "runtime/skip/structures.hpp"

namespace brace {

namespace {

constexpr int lazy_maps_per_piece = 8;

int log2_floor(int n) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(n))) - 1;
}

}  // namespace

int RangeCover::maps() const {
  switch (kind_) {
    case RangeMinima::none:
      return leaves_;
    case RangeMinima::segment_tree:
      return leaves_ > 1 ? 2 * leaves_ - 1 : leaves_;
    case RangeMinima::sparse_table: {
      int maps = 0;
      for (int level = 0; (1 << level) <= leaves_; ++level)
        maps += leaves_ - (1 << level) + 1;
      return maps;
    }
  }
  return leaves_;
}

// Segment tree: node i of the usual array (root 1, leaf p at leaves + p, children 2 i and 2 i + 1) is map p
// for a leaf and map leaves + (leaves - 1 - i) for an inner node, so that children come first.
std::vector<RangeCover::Pair> RangeCover::pairs() const {
  std::vector<Pair> pairs;
  if (kind_ == RangeMinima::segment_tree) {
    const auto map_of = [&](int node) { return node >= leaves_ ? node - leaves_ : 2 * leaves_ - 1 - node; };
    for (int node = leaves_ - 1; node >= 1; --node)
      pairs.push_back({map_of(node), map_of(2 * node), map_of(2 * node + 1)});
  } else if (kind_ == RangeMinima::sparse_table) {
    int below = 0, at = leaves_;  // first map of the level below, and of this one
    for (int level = 1; (1 << level) <= leaves_; ++level) {
      const int count = leaves_ - (1 << level) + 1;
      for (int p = 0; p < count; ++p)
        pairs.push_back({at + p, below + p, below + p + (1 << (level - 1))});
      below = at;
      at += count;
    }
  }
  return pairs;
}

void RangeCover::cover(PartitionRun run, std::vector<int>& maps) const {
  switch (kind_) {
    case RangeMinima::none:
      for (int p = run.begin; p < run.end; ++p)
        maps.push_back(p);
      return;
    case RangeMinima::segment_tree: {
      const auto map_of = [&](int node) { return node >= leaves_ ? node - leaves_ : 2 * leaves_ - 1 - node; };
      for (int low = run.begin + leaves_, high = run.end + leaves_; low < high; low /= 2, high /= 2) {
        if (low % 2 == 1) maps.push_back(map_of(low++));
        if (high % 2 == 1) maps.push_back(map_of(--high));
      }
      return;
    }
    case RangeMinima::sparse_table: {
      const int level = log2_floor(run.end - run.begin);
      int first = 0;
      for (int l = 0; l < level; ++l)
        first += leaves_ - (1 << l) + 1;
      maps.push_back(first + run.begin);
      if (run.end - run.begin > (1 << level)) maps.push_back(first + run.end - (1 << level));
      return;
    }
  }
}

PartitionedStructure::PartitionedStructure(SkipKernels& kernels, const SkipScene& scene,
                                           const SkipOptions& options, const Progress& progress)
    : SkipStructure(kernels, scene, options),
      partitioning_(make_partitioning(scene, options)),
      cover_(options.range_minima, partitioning_.count()),
      planes_(cached_planes(kernels, scene, grid_, partitioning_, options,
                            [&](double done) {
                              if (progress) progress(0.5 * done);
                            })),
      maps_(kernels.device(), grid_, "partitioned distance maps"),
      merged_(kernels.device(), grid_, "merged distance map") {
  merged_.append(1);
  bind_map(BRACE_SKIP_MAP_DISTANCES, *merged_.place(0).buffer, *merged_.place(0).words);
  const DistanceMaps::Place target = merged_.place(0);
  warm_merges(kernels, MergeKind::smallest_byte, *target.quads,
              bind_range(device(), 2, *target.buffer, 0, grid_.map_bytes(), "a distance map"));
  if (options.lazy) {
    map_of_.assign(static_cast<std::size_t>(partitioning_.count()), -1);
  } else {
    build_maps(progress);
    planes_ = {};
  }
  if (progress) progress(1.0);
}

void PartitionedStructure::build_maps(const Progress& progress) {
  const int n = partitioning_.count();
  maps_.append(cover_.maps());
  gpu::CommandList commands(device(), "skip maps build");
  constexpr int batch_max = 16;
  for (int p = 0; p < n; p += batch_max) {
    const int batch = std::min(batch_max, n - p);
    commands.reset();
    record_transform(commands, *kernels_, grid_, planes_.words(), p, maps_, p, batch);
    gpu::submit_and_wait(commands);
    if (progress) progress(0.5 + 0.4 * (p + batch) / n);
  }
  const auto pairs = cover_.pairs();
  for (std::size_t i = 0; i < pairs.size();) {
    commands.reset();
    for (const std::size_t end = std::min(i + 128, pairs.size()); i < end; ++i) {
      const int sources[] = {pairs[i].a, pairs[i].b};
      record_minimum(commands, *kernels_, grid_, maps_, sources, maps_, pairs[i].map);
    }
    gpu::submit_and_wait(commands);
    if (progress) progress(0.9 + 0.1 * static_cast<double>(i) / static_cast<double>(pairs.size()));
  }
}

std::uint64_t PartitionedStructure::make_missing(gpu::CommandList& commands,
                                                 const std::vector<bool>& visible) {
  std::uint64_t bytes = 0;
  for (const PartitionRun run : runs_of(visible)) {
    for (int p = run.begin; p < run.end; ++p) {
      int& map = map_of_[static_cast<std::size_t>(p)];
      if (map >= 0) continue;
      const auto used =
          static_cast<int>(std::count_if(map_of_.begin(), map_of_.end(), [](int m) { return m >= 0; }));
      if (used == maps_.count()) maps_.append(std::min(lazy_maps_per_piece, partitioning_.count() - used));
      map = used;
      bytes += record_transform(commands, *kernels_, grid_, planes_.words(), p, maps_, map, 1);
    }
  }
  return bytes;
}

WorkCounts PartitionedStructure::update(gpu::CommandList& commands, const TransferTable& table) {
  const std::vector<bool> visible = visibility(table).partitions(partitioning_);
  WorkCounts work;
  std::vector<int> sources;
  for (const PartitionRun run : runs_of(visible))
    cover_.cover(run, sources);
  if (!map_of_.empty()) {
    work.bytes += make_missing(commands, visible);
    for (int& source : sources)
      source = map_of_[static_cast<std::size_t>(source)];
  }
  std::sort(sources.begin(), sources.end());  // piece by piece
  work.bytes += record_minimum(commands, *kernels_, grid_, maps_, sources, merged_, 0);
  return work;
}

std::uint64_t PartitionedStructure::device_bytes() const {
  return maps_.device_bytes() + merged_.device_bytes() + (map_of_.empty() ? 0 : planes_.device_bytes());
}

}  // namespace brace
