#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// One clause of the suite, kept or broken by a stage.
struct ClauseResult {
  std::string clause;  // "outputs are finite"
  bool passed = false;
  std::string figure;  // what was measured: "0 of 13,104 rays"; the first fault where there is one
};

struct CheckOptions {
  /// With validation layers where they are installed: one clause is that they stay silent.
  const gpu::Device* device = nullptr;
  std::filesystem::path data_folder;  // share/brace
  /// The largest picture of the clause on sizes; the others go from 1x1 to 129x65.
  int large_width_px = 1024, large_height_px = 768;
  /// Called after every clause; may be empty.
  std::function<void(const ClauseResult&)> on_clause;
};

/// Runs the conformance suite of the stage's kind. A stage that fails is a result, not an exception; an
/// exception (brace::Error) means that the suite itself cannot work here. Results come in the order of the
/// suite; after a stage that cannot even be made or activated the rest is left out.
///
///   every kind   lifecycle, repeated activation, determinism, parameters at their ends; native stages also:
///   no
///                leaks, no allocation per frame
///   cast         sizes (1x1, odd, large), every ray written, finite, colour and opacity and depth in range,
///                nothing for rays that miss, inputs left alone, nothing outside the area and the buffers
///   rays         the same for both braces
///   skip         block edge, a byte per block, never farther than the next visible block
///   stereo, warp sizes, every pixel written, colours in range, inputs left alone, nothing outside the
///   buffers predict, control, cost   results in range for ordinary and extreme input with a device: no
///   message of the validation layers
std::vector<ClauseResult> check_stage(const StageInfo& stage, const CheckOptions& options);

}  // namespace brace
