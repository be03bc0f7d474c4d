#pragma once

#include <vector>

#include "base/image.hpp"
#include "runtime/metrics/frame_record.hpp"
#include "runtime/report/report_input.hpp"

namespace brace {

/// Records and jobs as a run might make them, from a seed: ray casting that takes 8 to 30 ms against 90 Hz, a
/// warp before each vsync, a rolling panel, and a head that turns for one second in two.
struct MadeUpRun {
  std::vector<FrameRecord> records;
  std::vector<JobRecord> jobs;
};

struct MadeUpParams {
  int vsyncs = 900;
  unsigned seed = 1;
  double cast_ms = 9.0;      // typical
  double dssim_scale = 1.0;  // of the image error
};

MadeUpRun made_up_run(const MadeUpParams& params);

/// A picture with something to see in it, as a lens would show it.
ImageRgba8 made_up_eye(int size_px, double turn_rad);

/// Everything but series, filled in.
ReportInput made_up_input();

}  // namespace brace
