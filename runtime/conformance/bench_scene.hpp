#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/conformance/suite.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/raycast/native_steps.hpp"
#include "runtime/volume/statistics.hpp"

namespace brace {

// Inside runtime/conformance only: a small volume on the device, eyes to look at it with, and buffers with
// guard zones.

/// A buffer with a pattern behind its used part.
class GuardedBuffer {
 public:
  GuardedBuffer() = default;
  GuardedBuffer(const gpu::Device& device, const std::string& name, std::uint64_t size_bytes);

  const gpu::Buffer& buffer() const { return buffer_; }
  std::uint64_t size_bytes() const { return size_bytes_; }
  brace_buffer_range range() const { return buffer_range(buffer_, 0, size_bytes_); }

  /// Every used word becomes `word`; the guard is armed.
  void fill(const gpu::Device& device, std::uint32_t word) const;
  void write(const gpu::Device& device, std::span<const std::byte> bytes) const;
  std::vector<std::byte> read(const gpu::Device& device) const;
  /// Words of the guard that were overwritten.
  std::uint64_t spoilt(const gpu::Device& device) const;

 private:
  gpu::Buffer buffer_;
  std::uint64_t size_bytes_ = 0;
};

/// Words of a buffer's last watchdog_guard_bytes; arm writes the pattern, spoilt counts what became of it.
void arm_guard(const gpu::Device& device, const gpu::Buffer& buffer);
std::uint64_t spoilt_words(const gpu::Device& device, const gpu::Buffer& buffer);

/// From outside with rays that miss, from inside, and past the volume.
enum class BenchView { outside, inside, away };
inline constexpr std::array bench_views = {BenchView::outside, BenchView::inside, BenchView::away};

struct PictureSizePx {
  int width = 24, height = 16;
};
inline constexpr PictureSizePx usual_size{24, 16};
std::vector<PictureSizePx> bench_sizes(const CheckOptions& options);

struct BenchScene {
  explicit BenchScene(const gpu::Device& device);

  Volume host_volume;
  VoxelScan scan;
  VolumeOnDevice volume;
  TransferTable table;
  TransferOnDevice transfer;
  VolumePlacement placement;
  static constexpr double step_units = 0.5;
};

EyeView bench_eye(BenchView view, PictureSizePx size);

/// The braces put together from a stage under test and the suite's own snippets for the families named here;
/// a stage of another family keeps its own. `more`: what is bound beside the scene, rays and picture.
CastPipeline bench_pipeline(const CheckOptions& options, const BenchScene& scene, const PipelineStage& stage,
                            const std::vector<std::pair<std::string, std::string>>& snippets,
                            std::span<const gpu::Binding> more = {});

/// Snippets of the suite.
extern const char* const plain_rays_snippet;
extern const char* const plain_cast_snippet;  // emission and absorption; asks the skip stage
extern const char* const empty_cast_snippet;

/// Gives the values "n of m what", and throws Broken unless n is 0.
std::string none_of(std::uint64_t bad, std::uint64_t of, const std::string& what);

}  // namespace brace
