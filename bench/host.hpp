#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"

namespace brace {

/// What it costs a frame that its stages are behind the C interface: the host fills the structs, calls
/// through the library's function pointers and checks what comes back. The stages themselves do nothing.
struct HostBenchOptions {
  const gpu::Device* device = nullptr;  // whose buffers the frames describe; nothing is submitted
  int frames = 200'000;
  std::filesystem::path data_folder;  // share/brace
};

struct HostBenchCase {
  std::string name;         // "cast", …, "whole frame"
  double calls = 0;         // into stages, per frame
  double ns_per_frame = 0;  // median over batches
  double ns_p95 = 0;
  double allocations_per_frame = 0;
};

/// Host time until the first frame of one eye is there, with cast/dvr.
struct HostBenchStart {
  double cold_s = 0;  // nothing in the SPIR-V cache
  double warm_s = 0;  // everything in it
};

struct HostBenchResult {
  std::string device;
  int frames = 0;
  std::vector<HostBenchCase> cases;  // the last is the whole frame
  HostBenchStart start;
};

inline constexpr double host_overhead_target_ns = 5'000.0;

inline constexpr double cold_start_target_s = 3.0;
inline constexpr double warm_start_target_s = 0.3;

HostBenchResult bench_host(const HostBenchOptions& options);
HostBenchStart bench_start(const gpu::Device& device, const std::filesystem::path& data_folder);

std::string to_text(const HostBenchResult& result);
std::string to_json(const HostBenchResult& result);

}  // namespace brace
