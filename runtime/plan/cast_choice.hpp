#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/gpu/measurements.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// A raycaster's time on this machine.
struct CastTime {
  std::string cast;       // stage's name: "dvr", "native"
  double frame_ms = 0.0;  // both eyes, shortest of some frames
};

/// The raycaster for a device.
struct CastChoice {
  std::string cast;             // "native" where it is clearly faster on a software device, else "dvr"
  std::vector<CastTime> times;  // of those there are
  std::string origin;           // of the times: when they were measured
};

/// Times cast/dvr and, where it is there, cast/native on one small scene, with skipping: a second on two
/// cores, once per device, driver, host threads and text of either, as long as `measurements` keeps it.
CastChoice choose_cast(const gpu::Device& device, const StageRegistry& stages,
                       const std::filesystem::path& data_folder, gpu::Measurements& measurements);

}  // namespace brace
