#include "runtime/timeline/gpu_time.hpp"

#include <array>

namespace brace {

GpuTime gpu_time(std::span<const JobRecord> jobs) {
  std::array<double, job_kind_count> ms{};
  double eye_frames = 0.0, display_images = 0.0;
  for (const JobRecord& job : jobs) {
    if (job.end_ns < 0) continue;
    ms[static_cast<std::size_t>(job.kind)] += static_cast<double>(job.cost_ns) * 1e-6;
    if (job.kind == JobKind::cast && job.ends_frame) eye_frames += 1.0;
    if (job.kind == JobKind::warp) display_images += 1.0;
  }
  const auto mean = [&](JobKind kind, double count) {
    return count == 0.0 ? 0.0 : ms[static_cast<std::size_t>(kind)] / count;
  };
  return {mean(JobKind::cast, eye_frames), mean(JobKind::update, eye_frames),
          mean(JobKind::warp, display_images)};
}

}  // namespace brace
