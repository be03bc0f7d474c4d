#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// A raycaster's time on this machine.
struct CastTime {
  std::string cast;       // stage's name: "dvr", "native"
  double frame_ms = 0.0;  // both eyes, shortest of some frames
};

/// Times those of cast/dvr and cast/native that there are on one small scene, with skipping: a second on two
/// cores.
std::vector<CastTime> time_casts(const gpu::Device& device, const StageRegistry& stages,
                                 const std::filesystem::path& data_folder);

/// The rule for pipeline.cast: cast/dvr on a GPU; on a software device whichever is faster here.
std::string recommended_cast(const gpu::Device& device, const std::vector<CastTime>& times);

}  // namespace brace
