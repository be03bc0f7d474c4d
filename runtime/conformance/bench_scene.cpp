#include "runtime/conformance/bench_scene.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/volume/generators.hpp"

namespace brace {

namespace {

constexpr std::uint32_t kGuardWord = 0xb7ace5a5u;
// Empty corners, all values in the middle; no two edges alike.
constexpr const char* kVolume = "generator:nested_shells:36x28x32";

TransferTable bench_table() {
  TransferTable table;
  table.range = {0.0, 255.0};
  for (int i = 0; i < 256; ++i) {
    const double v = i / 255.0;
    table.entries.push_back({v, 0.25 + 0.5 * v, 1.0 - v, i < 100 ? 0.0 : 0.8 * (v - 99.0 / 255.0)});
  }
  return table;
}

}  // namespace

const char* const plain_rays_snippet = R"(
#if defined(BRACE_KERNEL_OPENING)
BraceRay brace_open(uvec2 cell) { return brace_ray_through(vec2(cell) + 0.5); }
#endif
#if defined(BRACE_KERNEL_CLOSING)
void brace_close(uvec2 pixel, out vec4 colour, out float depth_m) {
  const uint index = brace_ray_index(pixel);
  colour = brace_result_colours[index];
  depth_m = brace_result_depths_m[index];
}
#endif
)";

const char* const plain_cast_snippet = R"(
#include "brace/transfer_function.glsl"
#include "brace/volume.glsl"
void brace_cast(BraceRay ray, inout BraceResult result) {
  BRACE_COUNTERS_DECLARE
  const float lattice_step = 0.5;
  const int count = int(ceil(ray.extent / lattice_step));
  float optical = 0.0;
  vec3 colour = vec3(0.0);
  int i = 0;
  while (i < count) {
    const float t = (float(i) + 0.5) * lattice_step;
    const vec3 voxel = ray.entry + t * ray.direction;
    const float coordinate = brace_transfer_coordinate(brace_volume(voxel));
    const float x = brace_optical_depth(coordinate);
    if (x > 0.0) {
      result.depth = min(result.depth, t);
      colour += (exp2(-optical) - exp2(-optical - x)) * brace_transfer_colour(coordinate);
      optical += x;
      i += 1;
    } else {
      BRACE_NEXT_SAMPLE(ray, voxel, i, lattice_step);
    }
  }
  const float opacity = 1.0 - exp2(-optical);
  result.colour = vec4(min(colour, vec3(opacity)), opacity);
  BRACE_COUNTERS_COMMIT;
}
)";

const char* const empty_cast_snippet = "void brace_cast(BraceRay ray, inout BraceResult result) {}\n";

void arm_guard(const gpu::Device& device, const gpu::Buffer& buffer) {
  const std::vector<std::uint32_t> words(watchdog_guard_bytes / 4, kGuardWord);
  gpu::upload_values(device, buffer, std::span<const std::uint32_t>(words),
                     buffer.size_bytes() - watchdog_guard_bytes);
}

std::uint64_t spoilt_words(const gpu::Device& device, const gpu::Buffer& buffer) {
  std::vector<std::uint32_t> words(watchdog_guard_bytes / 4);
  gpu::download_values(device, buffer, std::span<std::uint32_t>(words),
                       buffer.size_bytes() - watchdog_guard_bytes);
  return static_cast<std::uint64_t>(
      std::count_if(words.begin(), words.end(), [](std::uint32_t word) { return word != kGuardWord; }));
}

GuardedBuffer::GuardedBuffer(const gpu::Device& device, const std::string& name, std::uint64_t size_bytes)
    : buffer_(device, name, (size_bytes + 3) / 4 * 4 + watchdog_guard_bytes, gpu::Memory::device),
      size_bytes_((size_bytes + 3) / 4 * 4) {}

void GuardedBuffer::fill(const gpu::Device& device, std::uint32_t word) const {
  const std::vector<std::uint32_t> words(size_bytes_ / 4, word);
  gpu::upload_values(device, buffer_, std::span<const std::uint32_t>(words));
  arm_guard(device, buffer_);
}

void GuardedBuffer::write(const gpu::Device& device, std::span<const std::byte> bytes) const {
  BRACE_CHECK(bytes.size() == size_bytes_);
  gpu::upload(device, buffer_, bytes);
  arm_guard(device, buffer_);
}

std::vector<std::byte> GuardedBuffer::read(const gpu::Device& device) const {
  std::vector<std::byte> bytes(size_bytes_);
  gpu::download(device, buffer_, bytes);
  return bytes;
}

std::uint64_t GuardedBuffer::spoilt(const gpu::Device& device) const {
  return spoilt_words(device, buffer_);
}

BenchScene::BenchScene(const gpu::Device& device)
    : host_volume(load_volume(*open_volume(kVolume))),
      scan(host_volume.info.type),
      volume(device, *open_volume(kVolume), VolumePath::automatic, &scan),
      table(bench_table()),
      transfer(device, table, step_units, {.integrals = true, .segments = true}),
      placement{{}, 0.4} {}

std::vector<PictureSizePx> bench_sizes(const CheckOptions& options) {
  return {
      {1, 1}, {2, 1}, {1, 3}, {7, 5}, {33, 17}, {129, 65}, {options.large_width_px, options.large_height_px}};
}

EyeView bench_eye(BenchView view, PictureSizePx size) {
  EyeView eye;
  eye.width_px = size.width;
  eye.height_px = size.height;
  eye.tan_left = -0.45;
  eye.tan_right = 0.5;
  eye.tan_bottom = -0.4;
  eye.tan_top = 0.42;
  eye.world_from_eye.orientation = quat_exp({0.08, 0.11, 0.05});
  eye.world_from_eye.position = {0.08, -0.05, 0.7};
  if (view == BenchView::inside) eye.world_from_eye.position = {0.01, 0.02, 0.03};
  if (view == BenchView::away) eye.world_from_eye.orientation = quat_exp({0.0, 3.0, 0.0});
  return eye;
}

CastPipeline bench_pipeline(const CheckOptions& options, const BenchScene& scene, const PipelineStage& stage,
                            const std::vector<std::pair<std::string, std::string>>& snippets,
                            std::span<const gpu::Binding> more) {
  const PipelineStage* const chosen[] = {&stage};
  StageGlsl glsl = stage_glsl(chosen);
  CastParts parts;
  parts.glsl_folder = options.data_folder / "glsl";
  parts.kernels_folder = options.data_folder / "kernels";
  parts.constants = glsl.constants;
  parts.stages = [snippets, of_stage = std::move(glsl.resolve)](
                     std::string_view name) -> std::optional<gpu::GlslSource> {
    for (const auto& [family, text] : snippets) {
      const std::string include = "stage/" + family + ".glsl";
      if (name == include) return gpu::GlslSource{"suite/" + family + ".glsl", text};
    }
    return of_stage(name);
  };
  const CastKernels kernels = compose_cast_kernels(parts, scene.volume);
  for (const gpu::KernelDescription* kernel : {&kernels.opening, &kernels.cast, &kernels.closing}) {
    const gpu::CompiledKernel compiled = gpu::compile(*kernel);
    for (const auto& binding : gpu::reflect(compiled.spirv, kernel->main.name).bindings) {
      const bool is_bound = std::any_of(more.begin(), more.end(),
                                        [&](const gpu::Binding& one) { return one.slot == binding.slot; });
      if (is_bound || binding.slot <= CastSlot::eye_depth || binding.slot == CastSlot::transfer_integrals ||
          binding.slot == CastSlot::transfer_segments) {
        continue;
      }
      throw input_error("{}: stage {} binds '{}' to slot {}; accepted: slots 0 to {}, which the host fills",
                        stage.stage.origin.string(), stage.stage.id(), binding.name, binding.slot,
                        CastSlot::eye_depth);
    }
  }
  return CastPipeline(*options.device, kernels);
}

std::string none_of(std::uint64_t bad, std::uint64_t of, const std::string& what) {
  const std::string figure = fmt::format("{} of {} {}", bad, of, what);
  if (bad != 0) throw Broken(figure);
  return figure;
}

}  // namespace brace
