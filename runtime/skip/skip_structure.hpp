#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plugins/abi/glsl/brace/skip_params.h"
#include "runtime/metrics/frame_record.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/raycast/volume_on_device.hpp"
#include "runtime/skip/bit_planes.hpp"
#include "runtime/skip/block_grid.hpp"
#include "runtime/skip/partitioning.hpp"
#include "runtime/skip/skip_kernels.hpp"
#include "runtime/volume/statistics.hpp"

namespace brace {

struct PipelineStage;

/// The skip stages of stages/skip; `none` has no structure.
enum class SkipKind { none, block, distance_map, partitioned, bitmask, octree };

/// The name without the family: "distance_map". parse throws input_error naming those there are.
const char* to_string(SkipKind kind);
SkipKind parse_skip_kind(const std::string& name);

enum class Partitions { uniform, minimum_apart, adaptive };
enum class RangeMinima {
  none,          // a merge reads every map the transfer function shows
  segment_tree,  // n - 1 maps more; at most 2 log2 n maps for each run of visible partitions
  sparse_table   // about n (log2 n - 1) maps more; two maps for each run
};

struct SkipOptions {
  SkipKind kind = SkipKind::none;
  int block_voxels = 4;  // 2 ... 16
  int partitions = 64;   // 1 ... 256
  Occupancy occupancy = Occupancy::cell;
  Partitions placement = Partitions::uniform;
  RangeMinima range_minima = RangeMinima::none;
  bool lazy = false;                   // partitioned: a map is made when a transfer function first shows it
  std::uint64_t memory_bytes_max = 0;  // 0: nine tenths of the device's memory
  std::filesystem::path cache_folder;  // bit planes are kept here by content; empty: nothing is kept
};

/// The options from a session's stage: parameters block_voxels, partitions, occupancy, placement,
/// range_minima, lazy and cache, as far as the stage has them. `cache_folder` is taken if the stage's `cache`
/// is true.
SkipOptions skip_options(const PipelineStage& stage, const std::filesystem::path& cache_folder = {});

/// Device memory of a structure, known before it is built.
struct SkipMemory {
  std::uint64_t kept_bytes = 0;     // while the structure lives
  std::uint64_t scratch_bytes = 0;  // more than that while it is built
  std::string formula;              // "64 maps x 1884160 bytes (128 x 128 x 115 blocks) + …"
};
SkipMemory skip_memory(const VolumeInfo& volume, const SkipOptions& options);

/// What a structure is made for. `tables` are the transfer functions in use (placement "adaptive").
struct SkipScene {
  const VolumeOnDevice& volume;
  const VoxelStatistics& statistics;
  std::span<const TransferTable> tables = {};
};

/// A structure over a volume's blocks that tells the ray caster which samples are transparent without taking
/// them. The kernels, the volume and the device must outlive it.
class SkipStructure {
 public:
  virtual ~SkipStructure() = default;
  SkipStructure(const SkipStructure&) = delete;
  SkipStructure& operator=(const SkipStructure&) = delete;

  /// What the stage's snippet binds; the same from update to update.
  std::span<const gpu::Binding> bindings() const { return bindings_; }
  /// The same for casts on the host.
  SkipMapBuffers map_buffers() const { return {map_kind_, map_words_, &params_buffer_}; }

  /// Records the work of a change to `table`, with a barrier at its end, and returns the bytes it reads and
  /// writes. Writes small host-visible buffers at once: whatever was submitted before must be done, and the
  /// structure serves the old table no longer. Takes no new memory (a lazy structure apart, and only until
  /// each of its maps is made).
  virtual WorkCounts update(gpu::CommandList& commands, const TransferTable& table) = 0;

  const BlockGrid& grid() const { return grid_; }
  virtual std::uint64_t device_bytes() const = 0;

 protected:
  SkipStructure(SkipKernels& kernels, const SkipScene& scene, const SkipOptions& options);

  Visibility visibility(const TransferTable& table) const { return Visibility(table, slack_); }
  /// `words` is a view of `buffer`; both must stay where they are.
  void bind_map(brace_skip_map kind, const gpu::Buffer& buffer, const gpu::TexelBuffer& words);
  void write_params(const BraceSkipParams& params);
  const gpu::Device& device() const { return kernels_->device(); }

  SkipKernels* kernels_;
  BlockGrid grid_;
  BraceSkipParams params_{};

 private:
  Slack slack_;
  gpu::Buffer params_buffer_;
  std::vector<gpu::Binding> bindings_;
  brace_skip_map map_kind_ = BRACE_SKIP_MAP_NONE;
  const gpu::Buffer* map_words_ = nullptr;
};

/// Builds a structure; null for SkipKind::none. Throws input_error on options out of range and device_error
/// when the memory, stated in the message, is not there.
std::unique_ptr<SkipStructure> make_skip_structure(SkipKernels& kernels, const SkipScene& scene,
                                                   const SkipOptions& options, const Progress& progress = {});

/// The partitions that options ask for.
Partitioning make_partitioning(const SkipScene& scene, const SkipOptions& options);

/// The slack of interpolation as the volume lies on the device.
Slack interpolation_slack(const VolumeOnDevice& volume, ValueRange data_range);

}  // namespace brace
