#pragma once

#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include "gpu/gpu_fixture.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/skip/distance_maps.hpp"
#include "runtime/skip/skip_structure.hpp"
#include "skip/oracle.hpp"

namespace brace {

/// A volume in memory as a source.
class MemorySource final : public VolumeSource {
 public:
  explicit MemorySource(const Volume& volume) : VolumeSource(volume.info), volume_(volume) {}

 private:
  void produce(std::span<std::byte> out, int z_begin, int) override {
    const auto begin = static_cast<std::size_t>(z_begin) * volume_.info.slice_bytes();
    std::copy_n(volume_.voxels.begin() + static_cast<std::ptrdiff_t>(begin), out.size(), out.begin());
  }
  const Volume& volume_;
};

/// What the tests of skipping share: kernels compiled once, volumes and tables made up.
class SkipTest : public gpu::GpuTest {
 protected:
  static void TearDownTestSuite();

  static SkipKernels& kernels();  // made at first use

  /// Bytes of the map or bits that a structure binds, one value per block: what its snippet would see.
  static oracle::BlockValues distances(const DistanceMaps& maps, int map, const BlockGrid& grid);
  static oracle::BlockValues bits(const gpu::Buffer& planes, int plane, const BlockGrid& grid);

 private:
  static inline std::unique_ptr<SkipKernels> kernels_;
};

using Random = std::mt19937;

int random_int(Random& random, int low, int high);  // both ends included

/// Noise, blobs in a constant, or a constant; dims 1 … size_max.
Volume random_volume(Random& random, VoxelType type, int size_max);

/// A table over the volume's values, visible in a few random runs of entries (or nowhere, or everywhere).
TransferTable random_table(Random& random, const VoxelStatistics& statistics);

/// `entries` absorb where `visible` says so.
TransferTable table_of(ValueRange range, const std::vector<bool>& visible);

/// TF1 … TF6 of the paper as tables over [0, 255].
TransferTable paper_table(int number, ValueRange range);

std::filesystem::path source_folder();

}  // namespace brace
