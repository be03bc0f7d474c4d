#include "runtime/raycast/cast_pipeline.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::size_t kCounterRows = 64;  // BRACE_COUNTER_ROWS
constexpr std::size_t kCounterWords = 8;  // low and high word of four counters

gpu::KernelDescription describe_kernel(const CastParts& parts, const char* name,
                                       const gpu::IncludeResolver& resolve) {
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(parts.kernels_folder / name);
  kernel.resolve = resolve;
  kernel.constants = parts.constants;
  return kernel;
}

gpu::ComputePipeline make_if_there(const gpu::Device& device, const gpu::KernelDescription& kernel,
                                   const gpu::CompileOptions& options) {
  return kernel.main.text.empty() ? gpu::ComputePipeline() : gpu::make_pipeline(device, kernel, options);
}

std::uint64_t pixels(int width, int height) {
  return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
}

}  // namespace

CastKernels compose_cast_kernels(const CastParts& parts, const VolumeOnDevice& volume) {
  const auto resolve = gpu::chain_resolvers({parts.stages, gpu::directory_resolver({parts.glsl_folder})});
  CastKernels kernels;
  if (!parts.native_rays) {
    kernels.opening = describe_kernel(parts, "rays_main.comp", resolve);
    kernels.closing = describe_kernel(parts, "close_main.comp", resolve);
  }
  if (parts.layers_by_ray) kernels.closing.defines.emplace_back("BRACE_LAYERS_BY_RAY", "1");
  if (!parts.native_cast) kernels.cast = describe_kernel(parts, "cast_main.comp", resolve);
  if (parts.replays_segments) kernels.cast = describe_kernel(parts, "emit_main.comp", resolve);
  kernels.cast.defines = volume.defines();
  if (parts.phong) kernels.cast.defines.emplace_back("BRACE_SHADING_PHONG", "1");
  for (auto& define : defines(parts.sampled))
    kernels.cast.defines.push_back(std::move(define));
  if (parts.counters) kernels.cast.defines.emplace_back("BRACE_COUNTERS", "1");
  return kernels;
}

EyeTarget::EyeTarget(const gpu::Device& device, int width, int height, RayLayers wanted)
    : width_px(width),
      height_px(height),
      image(device, "eye image", pixels(width, height) * 4, gpu::Memory::device),
      depth(device, "eye depth", pixels(width, height) * 4, gpu::Memory::device),
      image_texels(device, image, gpu::Format::r32_uint),
      depth_texels(device, depth, gpu::Format::r32_float),
      params(device, "eye parameters", sizeof(BraceEyeParams), gpu::Memory::upload) {
  if (wanted.count == 0) return;
  const std::uint64_t rays = wanted.rays == 0 ? pixels(width, height) : wanted.rays;
  const std::uint64_t bytes = rays * static_cast<std::uint64_t>(wanted.count) * 16;
  const std::uint64_t bytes_max = device.limits().storage_buffer_bytes_max;
  if (bytes > bytes_max) {
    throw input_error(
        "{} layers of {} rays ({} x {} px) need {} bytes, but {} binds at most {}: accepted: at most {} "
        "layers, or "
        "a smaller device.resolution_scale",
        wanted.count, rays, width, height, bytes, device.info().name, bytes_max, bytes_max / (rays * 16));
  }
  layers = gpu::Buffer(device, "eye layers", bytes, gpu::Memory::device);
  if (wanted.rays != 0)
    layer_rays = gpu::Buffer(device, "rays of pixels", pixels(width, height) * 4, gpu::Memory::device);
  gpu::CommandList clear(device, "clear eye layers");
  clear.fill(layers, 0);
  if (wanted.rays != 0) clear.fill(layer_rays, 0);
  gpu::submit_and_wait(clear);
}

RayBuffers::RayBuffers(const gpu::Device& device, int across_rays, int down_rays, std::uint64_t guard_bytes)
    : across(across_rays), down(down_rays) {
  const std::uint64_t rays = pixels(across, down);
  const std::uint64_t bytes_max = device.limits().storage_buffer_bytes_max;
  if (rays * 16 > bytes_max) {
    throw device_error(
        "{} x {} rays need {} bytes of ray buffer, but {} binds at most {}: at most {} rays, a smaller "
        "device.resolution_scale fits",
        across, down, rays * 16, device.info().name, bytes_max, bytes_max / 16);
  }
  entries = gpu::Buffer(device, "ray entries", rays * 16, gpu::Memory::device);
  directions = gpu::Buffer(device, "ray directions", rays * 16, gpu::Memory::device);
  colours = gpu::Buffer(device, "ray colours", rays * 16 + guard_bytes, gpu::Memory::device);
  depths_m = gpu::Buffer(device, "ray depths", rays * 4 + guard_bytes, gpu::Memory::device);
}

CastPipeline::CastPipeline(const gpu::Device& device, const CastKernels& kernels,
                           const gpu::CompileOptions& options)
    : opening_(make_if_there(device, kernels.opening, options)),
      cast_(make_if_there(device, kernels.cast, options)),
      closing_(make_if_there(device, kernels.closing, options)),
      counters_(device, "work counters", kCounterRows * kCounterWords * 4, gpu::Memory::readback) {
  reset_counters(device);
}

void CastPipeline::set_eye(const gpu::Device& device, const EyeTarget& target, const EyeView& eye,
                           const VolumePlacement& placement, const VolumeOnDevice& volume,
                           const TransferOnDevice& transfer, const std::optional<RayGrid>& grid) {
  BRACE_CHECK(eye.width_px == target.width_px && eye.height_px == target.height_px);
  BraceEyeParams params = eye_params(eye, volume.info(), placement);
  transfer.describe(params);
  volume.describe(params);
  if (grid) {
    params.grid[0] = static_cast<std::uint32_t>(grid->across);
    params.grid[1] = static_cast<std::uint32_t>(grid->down);
    params.ray_base[3] = static_cast<float>(grid->left);
    params.ray_dx[3] = static_cast<float>(grid->top);
  }
  gpu::upload_values(device, target.params, std::span<const BraceEyeParams>(&params, 1));
}

void CastPipeline::record(gpu::CommandList& commands, const Resources& resources) const {
  const CastArea rays{0, 0, resources.rays_across(), resources.rays_down()};
  const CastArea image{0, 0, resources.target.width_px, resources.target.height_px};
  commands.barrier();
  commands.begin_timing("opening");
  record_opening(commands, resources, rays);
  commands.barrier();
  commands.end_timing();
  commands.begin_timing("cast");
  record_cast(commands, resources, rays);
  commands.barrier();
  commands.end_timing();
  commands.begin_timing("closing");
  record_closing(commands, resources, image);
  commands.barrier();
  commands.end_timing();
}

void CastPipeline::record_opening(gpu::CommandList& commands, const Resources& resources,
                                  const CastArea& area) const {
  dispatch(commands, opening_, resources, area);
}

void CastPipeline::record_cast(gpu::CommandList& commands, const Resources& resources,
                               const CastArea& area) const {
  if (resources.cast_twice) {
    dispatch(commands, cast_, resources, area);
    commands.barrier();
  }
  dispatch(commands, cast_, resources, area);
}

void CastPipeline::record_closing(gpu::CommandList& commands, const Resources& resources,
                                  const CastArea& area) const {
  dispatch(commands, closing_, resources, area);
}

void CastPipeline::dispatch(gpu::CommandList& commands, const gpu::ComputePipeline& pipeline,
                            const Resources& resources, const CastArea& area) const {
  if (area.width < 1 || area.height < 1) return;
  constexpr std::size_t own = 12;
  std::array<gpu::Binding, 40> bindings;
  BRACE_CHECK(own + resources.more.size() <= bindings.size());
  bindings[0] = gpu::bind(CastSlot::eye, resources.target.params);
  bindings[1] = gpu::bind(CastSlot::ray_entry, resources.rays.entries);
  bindings[2] = gpu::bind(CastSlot::ray_direction, resources.rays.directions);
  bindings[3] = gpu::bind(CastSlot::result_colour, resources.rays.colours);
  bindings[4] = gpu::bind(CastSlot::result_depth, resources.rays.depths_m);
  bindings[5] = resources.volume.binding(CastSlot::volume);
  bindings[6] = resources.transfer.binding(CastSlot::transfer);
  bindings[7] = gpu::bind(CastSlot::counters, counters_);
  bindings[8] = gpu::bind(CastSlot::eye_image, resources.target.image);
  bindings[9] = gpu::bind(CastSlot::eye_depth, resources.target.depth);
  bindings[10] = resources.transfer.integrals_binding(CastSlot::transfer_integrals);
  bindings[11] = resources.transfer.segments_binding(CastSlot::transfer_segments);
  std::copy(resources.more.begin(), resources.more.end(), bindings.begin() + own);
  const BraceArea params{{static_cast<std::uint32_t>(area.x), static_cast<std::uint32_t>(area.y)},
                         {static_cast<std::uint32_t>(area.width), static_cast<std::uint32_t>(area.height)}};
  commands.dispatch(pipeline, std::span<const gpu::Binding>(bindings.data(), own + resources.more.size()),
                    gpu::push_bytes(params), pipeline.groups_for(area.width, area.height));
}

WorkCounts CastPipeline::counted(const gpu::Device& device) const {
  std::array<std::uint32_t, kCounterRows * kCounterWords> words{};
  gpu::download_values(device, counters_, std::span<std::uint32_t>(words));
  std::array<std::uint64_t, 4> sums{};
  for (std::size_t i = 0; i < words.size(); i += 2) {
    sums[i / 2 % 4] += words[i] | static_cast<std::uint64_t>(words[i + 1]) << 32;
  }
  WorkCounts counts;
  counts.rays = sums[0];
  counts.samples = sums[1];
  counts.skip_steps = sums[2];
  counts.shading_fetches = sums[3];
  return counts;
}

void CastPipeline::reset_counters(const gpu::Device& device) const {
  const std::array<std::uint32_t, kCounterRows * kCounterWords> zero{};
  gpu::upload_values(device, counters_, std::span<const std::uint32_t>(zero));
}

}  // namespace brace
