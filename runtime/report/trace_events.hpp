#pragma once

#include <cstddef>
#include <filesystem>

#include "runtime/report/report_input.hpp"

namespace brace {

/// timeline.json in the Chrome trace event format (opens in Perfetto and chrome://tracing). A process per
/// series with the tracks vsync, ray casting, warp, scan-out, tracker poses, and updates where there are any.
/// Every slice names its eye frame and vsync in its args; a flow arrow goes from a frame's ray casting to the
/// scan-out that shows it first. Times are simulated, in microseconds, exact to the nanosecond.
///
/// A viewer holds the whole file in memory: the first `vsyncs_max` vsyncs of each series are written, and
/// "otherData" says how many of how many.
void write_trace_events(const std::filesystem::path& path, const ReportInput& input,
                        std::size_t vsyncs_max = 100'000);

}  // namespace brace
