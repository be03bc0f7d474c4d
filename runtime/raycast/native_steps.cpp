#include "runtime/raycast/native_steps.hpp"

#include <chrono>
#include <span>

#include "base/error.hpp"
#include "runtime/raycast/host_braces.hpp"
#include "runtime/raycast/segment_replay.hpp"

namespace brace {

namespace {

brace_volume_layout layout_of(const VolumeOnDevice& volume) {
  if (volume.path() == VolumePath::sampler) return BRACE_VOLUME_LAYOUT_IMAGE;
  switch (volume.info().type) {
    case VoxelType::uint8:
      return BRACE_VOLUME_LAYOUT_PACKED_8;
    case VoxelType::int16:
    case VoxelType::uint16:
      return BRACE_VOLUME_LAYOUT_PACKED_16;
    case VoxelType::float32:
      return BRACE_VOLUME_LAYOUT_TEXELS_32;
  }
  return BRACE_VOLUME_LAYOUT_IMAGE;
}

std::uint64_t ray_count(const CastPipeline::Resources& in) {
  return static_cast<std::uint64_t>(in.rays_across()) * static_cast<std::uint64_t>(in.rays_down());
}

brace_area to_abi(const CastArea& area) {
  return {static_cast<std::uint32_t>(area.x), static_cast<std::uint32_t>(area.y),
          static_cast<std::uint32_t>(area.width), static_cast<std::uint32_t>(area.height)};
}

/// Points a range at a copy in host memory if it is not mapped.
void bring(const gpu::Device& device, const gpu::Buffer& from, brace_buffer_range& range,
           std::vector<std::byte>& copy) {
  if (range.mapped != nullptr) return;
  copy.resize(range.size_bytes);
  gpu::download(device, from, copy, range.offset_bytes);
  range.mapped = copy.data();
}

void take_back(const gpu::Device& device, const gpu::Buffer& to, const brace_buffer_range& range,
               std::span<const std::byte> copy) {
  if (range.mapped == copy.data()) gpu::upload(device, to, copy, range.offset_bytes);
}

std::int64_t submit(gpu::CommandList& commands) {
  return gpu::total_ns(gpu::submit_and_wait(commands));
}

const std::string& id_of(const std::string* given, const NativeStage* stage) {
  static const std::string unknown = "a stage";
  return given != nullptr ? *given : stage != nullptr ? stage->id() : unknown;
}

void record_opening(const EyeCast& eye, gpu::CommandList& commands, const CastArea& rays) {
  commands.barrier();
  commands.begin_timing("opening");
  if (eye.rays != nullptr) {
    eye.rays->open(cast_frame(eye, commands.hand_out(), rays));
  } else {
    eye.pipeline.record_opening(commands, eye.resources, rays);
  }
  commands.barrier();
  commands.end_timing();
}

void record_cast(const EyeCast& eye, gpu::CommandList& commands, const CastArea& rays) {
  commands.begin_timing("cast");
  if (eye.cast != nullptr) {
    eye.cast->cast(cast_frame(eye, commands.hand_out(), rays));
  } else {
    eye.pipeline.record_cast(commands, eye.resources, rays);
  }
  commands.barrier();
  commands.end_timing();
}

void record_closing(const EyeCast& eye, gpu::CommandList& commands, const CastArea& image) {
  commands.begin_timing("closing");
  if (eye.rays != nullptr) {
    eye.rays->close(cast_frame(eye, commands.hand_out(), image));
  } else {
    eye.pipeline.record_closing(commands, eye.resources, image);
  }
  commands.barrier();
  commands.end_timing();
}

/// What the watchdog looks at after the cast, when the device is idle.
void watch_cast(const EyeCast& eye, std::int64_t cast_ns) {
  Watchdog& watchdog = *eye.watchdog;
  const std::string& id = id_of(eye.cast_id, eye.cast);
  const auto frame = static_cast<std::int64_t>(eye.frame);
  const RayBuffers& rays = eye.resources.rays;
  watchdog.collect_outputs(id, frame);
  watchdog.check_inputs(id, frame);
  watchdog.check_guard(id, frame, rays.colours);
  watchdog.check_guard(id, frame, rays.depths_m);
  watchdog.job_done(id, frame, cast_ns, eye.cast_deadline_ns);
}

}  // namespace

brace_eye_view to_abi(const EyeView& view) {
  return {brace::to_abi(view.world_from_eye),
          view.tan_left,
          view.tan_right,
          view.tan_bottom,
          view.tan_top,
          static_cast<std::uint32_t>(view.width_px),
          static_cast<std::uint32_t>(view.height_px)};
}

ActivationInput activation_input(const gpu::Device& device, const VolumeOnDevice& volume,
                                 const VolumePlacement& placement, const TransferTable& transfer,
                                 double step_units, int eye_width_px, int eye_height_px) {
  ActivationInput input;
  input.device = &device;
  input.eye_width_px = static_cast<std::uint32_t>(eye_width_px);
  input.eye_height_px = static_cast<std::uint32_t>(eye_height_px);
  input.ray_count_max = input.eye_width_px * input.eye_height_px;
  input.volume = &volume.info();
  input.open_volume = [source = volume.info().source] { return open_volume(source); };
  input.layout = layout_of(volume);
  input.volume_on_device = volume.binding(CastSlot::volume);
  input.metres_per_unit = metres_per_unit(volume.info(), placement);
  input.world_from_volume = placement.world_from_volume;
  input.transfer = &transfer;
  input.step_units = step_units;
  return input;
}

brace_cast_frame cast_frame(const EyeCast& eye, VkCommandBuffer_T* commands, const CastArea& area) {
  const CastPipeline::Resources& in = eye.resources;
  const std::uint64_t rays = ray_count(in);
  brace_cast_frame frame{};
  frame.struct_size = sizeof frame;
  frame.eye = eye.eye;
  frame.frame = eye.frame;
  frame.commands = commands;
  frame.view = to_abi(eye.view);
  frame.rays_across = static_cast<std::uint32_t>(in.rays_across());
  frame.rays_down = static_cast<std::uint32_t>(in.rays_down());
  frame.area = to_abi(area);
  frame.params = buffer_range(in.target.params);
  frame.ray_entries = buffer_range(in.rays.entries, 0, rays * 16);
  frame.ray_directions = buffer_range(in.rays.directions, 0, rays * 16);
  frame.result_colours = buffer_range(in.rays.colours, 0, rays * 16);
  frame.result_depths_m = buffer_range(in.rays.depths_m, 0, rays * 4);
  frame.eye_image = buffer_range(in.target.image);
  frame.eye_depth_m = buffer_range(in.target.depth);
  frame.transfer = buffer_range(in.transfer.buffer());
  frame.counters = buffer_range(eye.pipeline.counters());
  if (in.skip_map.kind != BRACE_SKIP_MAP_NONE) {
    frame.skip_map = in.skip_map.kind;
    frame.skip_words = buffer_range(*in.skip_map.words);
    frame.skip_params = buffer_range(*in.skip_map.params);
  }
  return frame;
}

SimDuration execute_cast(const EyeCast& eye, const CastArea& area, HostRays& host, WorkCounts& counted,
                         const brace_segment_sink* segments) {
  const auto begin = std::chrono::steady_clock::now();
  const RayBuffers& rays = eye.resources.rays;
  brace_cast_frame frame = cast_frame(eye, nullptr, area);
  bring(eye.device, eye.resources.target.params, frame.params, host.params);
  bring(eye.device, rays.entries, frame.ray_entries, host.entries);
  bring(eye.device, rays.directions, frame.ray_directions, host.directions);
  bring(eye.device, rays.colours, frame.result_colours, host.colours);
  bring(eye.device, rays.depths_m, frame.result_depths_m, host.depths_m);
  bring(eye.device, eye.resources.transfer.buffer(), frame.transfer, host.transfer);
  const SkipMapBuffers& skip = eye.resources.skip_map;
  if (skip.kind != BRACE_SKIP_MAP_NONE) {
    bring(eye.device, *skip.words, frame.skip_words, host.skip_words);
    bring(eye.device, *skip.params, frame.skip_params, host.skip_params);
  }
  brace_work_counts counts{};
  frame.counted = &counts;
  frame.segments = segments;
  eye.cast->cast(frame);
  take_back(eye.device, rays.colours, frame.result_colours, host.colours);
  take_back(eye.device, rays.depths_m, frame.result_depths_m, host.depths_m);
  counted.rays += counts.rays;
  counted.samples += counts.samples;
  counted.skip_steps += counts.skip_steps;
  counted.shading_fetches += counts.shading_fetches;
  return std::chrono::steady_clock::now() - begin;
}

bool has_host_braces(const EyeCast& eye) {
  return eye.full_rate && eye.rays == nullptr && eye.cast != nullptr && eye.cast->casts_on_host() &&
         eye.device.limits().is_software && maps_braces(eye.resources);
}

SimDuration cast_on_host(const EyeCast& eye, const CastArea& area, HostRays& host, WorkCounts& counted,
                         gpu::CommandList& commands) {
  return eye.segments != nullptr ? eye.segments->cast(eye, area, host, counted, commands)
                                 : execute_cast(eye, area, host, counted);
}

EyeCastOutcome cast_eye(const EyeCast& eye, gpu::CommandList& commands, HostRays& host) {
  const RayBuffers& buffers = eye.resources.rays;
  const CastArea rays{0, 0, eye.resources.rays_across(), eye.resources.rays_down()};
  const CastArea image{0, 0, eye.resources.target.width_px, eye.resources.target.height_px};
  const bool on_host = eye.cast != nullptr && eye.cast->casts_on_host();
  const bool watched = eye.watchdog != nullptr && eye.watchdog->watches_outputs();
  const auto frame = static_cast<std::int64_t>(eye.frame);
  EyeCastOutcome outcome;
  std::int64_t cast_ns = 0;

  const auto run = [&](const std::string& stage) {
    std::int64_t time_ns = 0;
    if (eye.watchdog == nullptr) return submit(commands);
    eye.watchdog->attribute_loss(stage, frame, [&] { time_ns = submit(commands); });
    return time_ns;
  };
  if (!watched && has_host_braces(eye)) {
    outcome.time_ns += to_ns(open_on_host(eye.resources, rays));
    outcome.time_ns += to_ns(cast_on_host(eye, rays, host, outcome.counted, commands));
    outcome.time_ns += to_ns(close_on_host(eye.resources, image));
    return outcome;
  }
  commands.reset();
  record_opening(eye, commands, rays);
  if (on_host || watched) {
    outcome.time_ns += run(id_of(eye.rays_id, eye.rays));
    commands.reset();
  }
  if (watched) {
    eye.watchdog->remember_input(buffers.entries);
    eye.watchdog->remember_input(buffers.directions);
    eye.watchdog->remember_input(eye.resources.target.params);
  }
  if (on_host) {
    cast_ns = to_ns(cast_on_host(eye, rays, host, outcome.counted, commands));
    outcome.time_ns += cast_ns;
  } else {
    record_cast(eye, commands, rays);
  }
  if (watched) {
    if (!on_host) {
      cast_ns = run(id_of(eye.cast_id, eye.cast));
      outcome.time_ns += cast_ns;
      commands.reset();
    }
    eye.watchdog->record_output_check(commands, buffers.colours, buffers.depths_m,
                                      static_cast<std::uint32_t>(ray_count(eye.resources)));
    (void)run(id_of(eye.cast_id, eye.cast));
    commands.reset();
    watch_cast(eye, cast_ns);
  }
  record_closing(eye, commands, image);
  outcome.time_ns += run(id_of(eye.rays_id, eye.rays));
  return outcome;
}

}  // namespace brace
