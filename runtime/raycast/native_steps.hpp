#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/time.hpp"
#include "runtime/host/native_stage.hpp"
#include "runtime/host/stage_activation.hpp"
#include "runtime/host/watchdog.hpp"
#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

// The braces with native stages in the place of kernels.

brace_eye_view to_abi(const EyeView& view);

/// Fills the parts of an activation that come from the scene: volume, transfer function, sizes.
ActivationInput activation_input(const gpu::Device& device, const VolumeOnDevice& volume,
                                 const VolumePlacement& placement, const TransferTable& transfer,
                                 double step_units, int eye_width_px, int eye_height_px);

class SegmentReplay;

/// One eye of one eye frame. Everything must outlive the call.
struct EyeCast {
  const gpu::Device& device;
  const CastPipeline& pipeline;
  const CastPipeline::Resources& resources;
  const EyeView& view;
  std::uint32_t eye = 0;  // 0 left, 1 right
  std::uint64_t frame = 0;
  const NativeStage* rays = nullptr;  // null: the pipeline's kernels
  bool full_rate = false;  // the rays are rays/full_rate's as they come: their braces may work on the host
  const NativeStage* cast = nullptr;
  Watchdog* watchdog = nullptr;
  const std::string* rays_id = nullptr;  // names for the watchdog; null: that of the native stage
  const std::string* cast_id = nullptr;
  std::int64_t cast_deadline_ns = 0;  // for the watchdog; 0: none
  SegmentReplay* segments = nullptr;  // where stages want those of a cast on the host
};

struct EyeCastOutcome {
  std::int64_t time_ns = 0;  // device time; of a cast on the host, its duration there
  WorkCounts counted;        // by a cast on the host
};

/// Host memory for casts on the host where the device's is not mapped; grows to its size once.
struct HostRays {
  std::vector<std::byte> params, entries, directions, colours, depths_m, transfer, skip_words, skip_params;
};

/// The frame as a stage sees it. `commands` null: on the host, with mapped ranges where there are any.
brace_cast_frame cast_frame(const EyeCast& eye, VkCommandBuffer_T* commands, const CastArea& area);

/// Runs a cast that executes on the host and returns how long it took there; the device is idle and the rays
/// are written. `segments` may be null.
SimDuration execute_cast(const EyeCast& eye, const CastArea& area, HostRays& host, WorkCounts& counted,
                         const brace_segment_sink* segments = nullptr);

/// Whether the braces work on the host: the cast does, the rays are full_rate's, and the device maps the
/// buffers.
bool has_host_braces(const EyeCast& eye);

/// The same, and what wants segments has been told of them; `commands` are used up where there are any.
SimDuration cast_on_host(const EyeCast& eye, const CastArea& area, HostRays& host, WorkCounts& counted,
                         gpu::CommandList& commands);

/// Opening brace, cast and closing brace of one eye; the work is done when it returns. Throws device_error
/// that names the stage when one fails. Allocates nothing once warm.
EyeCastOutcome cast_eye(const EyeCast& eye, gpu::CommandList& commands, HostRays& host);

}  // namespace brace
