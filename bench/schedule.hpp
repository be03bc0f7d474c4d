#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/host/stage_registry.hpp"

namespace brace {

/// schedule/chunked against schedule/whole_frame on simulated time: 3,000 vsyncs at 90 Hz; an eye frame takes
/// 6 ms, ten times as much in the middle third, a warp 1 ms. What is dear lies in one part of the picture
/// that wanders over it. Frames follow each other at once.
struct ScheduleBenchOptions {
  StageRegistry stages;
};

struct ScheduleBenchRow {
  std::string queue, schedule;  // "whole_frame", "clock 8 x 8", "prediction 8 x 8, bias 4"
  std::string order;
  double overhead_us = 0;   // per cell
  std::int64_t missed = 0;  // vsyncs
  std::int64_t longest_run = 0;
  std::int64_t eye_frames = 0;
  double throughput = 0;  // eye frames over those of whole_frame on the same queue
  double mtp_translation_p50_ms = 0;
};

struct ScheduleBenchResult {
  std::vector<ScheduleBenchRow> rows;
};

ScheduleBenchResult bench_schedule(const ScheduleBenchOptions& options);

std::string to_text(const ScheduleBenchResult& result);
std::string to_json(const ScheduleBenchResult& result);

}  // namespace brace
