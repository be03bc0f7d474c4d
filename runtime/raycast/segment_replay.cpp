#include "runtime/raycast/segment_replay.hpp"

#include <algorithm>
#include <new>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr int kRows = 32;  // at a time
constexpr std::uint64_t kPieceBytes = std::uint64_t{64} << 20;
constexpr std::uint32_t kHeadsSlot = 44, kSegmentsSlot = 45;  // brace/frame.glsl has the same
constexpr std::uint32_t kElsewhere = 0xffffffffu;             // emit_main.comp has the same

/// `buffer` holds at least so many bytes, and some when there are none.
void grow(const gpu::Device& device, gpu::Buffer& buffer, const char* name, std::uint64_t bytes) {
  if (buffer && buffer.size_bytes() >= bytes) return;
  const std::uint64_t ahead = std::min(bytes + bytes / 2, device.limits().storage_buffer_bytes_max);
  buffer = gpu::Buffer(device, name, std::max<std::uint64_t>({bytes, ahead, 4}), gpu::Memory::device);
}

}  // namespace

brace_result SegmentReplay::take(const brace_segment_sink* sink, const brace_ray_segments* rays,
                                 std::uint32_t count) {
  try {
    return static_cast<SegmentReplay*>(sink->host_context)->keep({rays, count});
  } catch (const std::bad_alloc&) {
    return BRACE_ERROR;
  }
}

brace_result SegmentReplay::keep(std::span<const brace_ray_segments> rays) {
  const std::lock_guard lock(mutex_);
  for (const brace_ray_segments& ray : rays) {
    const auto x = static_cast<int>(ray.ray % across_) - rows_.x;
    const auto y = static_cast<int>(ray.ray / across_) - rows_.y;
    if (x < 0 || x >= rows_.width || y < 0 || y >= rows_.height) return BRACE_INVALID_ARGUMENT;
    Told& told = told_[static_cast<std::size_t>(y) * static_cast<std::size_t>(rows_.width) +
                       static_cast<std::size_t>(x)];
    if (told.is_told) return BRACE_INVALID_ARGUMENT;
    told = {segments_.size(), ray.count, ray.end_units, true};
    segments_.insert(segments_.end(), ray.segments, ray.segments + ray.count);
  }
  return BRACE_OK;
}

SimDuration SegmentReplay::cast(const EyeCast& eye, const CastArea& area, HostRays& host, WorkCounts& counted,
                                gpu::CommandList& commands) {
  // Where results are not mapped, each cast on the host brings and takes back all of them.
  const int rows = eye.resources.rays.colours.is_mapped() ? kRows : std::max(area.height, 1);
  const brace_segment_sink sink{sizeof sink, this, &SegmentReplay::take};
  across_ = static_cast<std::size_t>(eye.resources.rays_across());
  SimDuration time{0};
  for (int y = 0; y < area.height; y += rows) {
    rows_ = {area.x, area.y + y, area.width, std::min(rows, area.height - y)};
    segments_.clear();
    told_.assign(static_cast<std::size_t>(rows_.width) * static_cast<std::size_t>(rows_.height), {});
    time += execute_cast(eye, rows_, host, counted, &sink);
    time += tell(eye, commands);
  }
  return time;
}

SimDuration SegmentReplay::tell(const EyeCast& eye, gpu::CommandList& commands) {
  const std::uint64_t bytes_max = std::min(kPieceBytes, device_.limits().storage_buffer_bytes_max);
  SimDuration time{0};
  std::size_t begin = 0;
  do {
    const std::size_t end = piece_end(begin, bytes_max / sizeof(brace_segment));
    bring(begin, end);
    bindings_.assign(eye.resources.more.begin(), eye.resources.more.end());
    bindings_.push_back(gpu::bind(kHeadsSlot, heads_on_device_));
    bindings_.push_back(gpu::bind(kSegmentsSlot, segments_on_device_));
    CastPipeline::Resources resources = eye.resources;
    resources.more = bindings_;
    resources.cast_twice = false;  // what becomes of a ray is known
    commands.reset();
    commands.barrier();
    commands.begin_timing("segments");
    eye.pipeline.record_cast(commands, resources, rows_);
    commands.barrier();
    commands.end_timing();
    time += SimDuration(gpu::total_ns(gpu::submit_and_wait(commands)));
    begin = end;
  } while (begin < segments_.size());
  commands.reset();
  return time;
}

/// The end of the last ray that fits beside those from `begin` on.
std::size_t SegmentReplay::piece_end(std::size_t begin, std::size_t segments_max) const {
  if (segments_.size() - begin <= segments_max) return segments_.size();
  std::size_t end = begin;
  for (const Told& told : told_) {
    const std::size_t last = told.first + told.count;
    if (last <= begin + segments_max) end = std::max(end, last);
  }
  if (end == begin)
    throw device_error("a ray with more than {} segments was cast; a longer step has fewer", segments_max);
  return end;
}

/// Rays without segments go with the first piece.
void SegmentReplay::bring(std::size_t begin, std::size_t end) {
  heads_.clear();
  for (const Told& told : told_) {
    const bool here = told.count == 0 ? begin == 0 : told.first >= begin && told.first + told.count <= end;
    const auto first = here && told.count > 0 ? static_cast<std::uint32_t>(told.first - begin) : 0u;
    heads_.push_back({first, here ? told.count : kElsewhere, told.end_units});
  }
  grow(device_, heads_on_device_, "segment heads", heads_.size() * sizeof(Head));
  grow(device_, segments_on_device_, "segments", (end - begin) * sizeof(brace_segment));
  gpu::upload_values(device_, heads_on_device_, std::span<const Head>(heads_));
  gpu::upload_values(device_, segments_on_device_,
                     std::span<const brace_segment>(segments_).subspan(begin, end - begin));
}

}  // namespace brace
