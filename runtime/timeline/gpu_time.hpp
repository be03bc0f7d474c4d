#pragma once

#include <span>

#include "runtime/timeline/job_record.hpp"

namespace brace {

/// What a frame takes of the simulated GPU, in milliseconds, means over the finished jobs of a run.
struct GpuTime {
  double cast_ms = 0.0;    // of an eye frame; its parts together if it is cast in cells
  double update_ms = 0.0;  // updates of the scene's structures, per eye frame
  double warp_ms = 0.0;    // of a display image
  double frame_ms() const { return cast_ms + update_ms + warp_ms; }  // an eye frame shown once
};

GpuTime gpu_time(std::span<const JobRecord> jobs);

}  // namespace brace
