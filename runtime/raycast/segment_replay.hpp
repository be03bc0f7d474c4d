#pragma once

#include <mutex>
#include <vector>

#include "runtime/raycast/native_steps.hpp"

namespace brace {

/// What a cast on the host tells of its segments, brought to the stages that make layers of them: these are
/// kernels, composed into emit_main.comp in the place of the cast kernel (CastParts::replays_segments). The
/// device must outlive it.
class SegmentReplay {
 public:
  explicit SegmentReplay(const gpu::Device& device) : device_(device) {}
  SegmentReplay(const SegmentReplay&) = delete;
  SegmentReplay& operator=(const SegmentReplay&) = delete;

  /// Casts an area on the host and tells the stages; some rows at a time, as a segment takes 24 bytes and a
  /// ray may have hundreds. The device is idle, and is again when it returns; `commands` are used up. Returns
  /// what the cast and the kernels took.
  SimDuration cast(const EyeCast& eye, const CastArea& area, HostRays& host, WorkCounts& counted,
                   gpu::CommandList& commands);

 private:
  struct Head {  // as emit_main.comp has it
    std::uint32_t first, count;
    float end_units;
  };
  struct Told {  // of a ray: its segments among those of its rows
    std::size_t first = 0;
    std::uint32_t count = 0;
    float end_units = 0.0f;
    bool is_told = false;
  };

  static brace_result take(const brace_segment_sink* sink, const brace_ray_segments* rays,
                           std::uint32_t count);
  brace_result keep(std::span<const brace_ray_segments> rays);
  SimDuration tell(const EyeCast& eye, gpu::CommandList& commands);
  std::size_t piece_end(std::size_t begin, std::size_t segments_max) const;
  void bring(std::size_t begin, std::size_t end);

  const gpu::Device& device_;
  std::mutex mutex_;  // threads of the stage tell
  CastArea rows_;     // that are being cast
  std::size_t across_ = 0;
  std::vector<brace_segment> segments_;
  std::vector<Told> told_;  // of the rays of rows_, row by row
  std::vector<Head> heads_;
  gpu::Buffer heads_on_device_, segments_on_device_;
  std::vector<gpu::Binding> bindings_;
};

}  // namespace brace
