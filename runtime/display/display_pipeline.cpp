#include "runtime/display/display_pipeline.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"

namespace brace {
namespace {

const char* lens_define(sim::LensKind kind) {
  switch (kind) {
    case sim::LensKind::none_published:
    case sim::LensKind::identity:
      return "BRACE_LENS_IDENTITY";
    case sim::LensKind::brown_conrady:
      return "BRACE_LENS_BROWN_CONRADY";
    case sim::LensKind::panotools:
      return "BRACE_LENS_PANOTOOLS";
    case sim::LensKind::vive:
      return "BRACE_LENS_VIVE";
  }
  return "BRACE_LENS_IDENTITY";
}

int round_up(int value, int step) {
  return (value + step - 1) / step * step;
}

std::vector<std::uint32_t> all_tiles(const PanelEye& eye) {
  std::vector<std::uint32_t> tiles;
  for (int row = 0; row * tile_height_px < eye.height_px; ++row)
    for (int column = 0; column * tile_width_px < eye.width_px; ++column)
      tiles.push_back(static_cast<std::uint32_t>(column) | static_cast<std::uint32_t>(row) << 16);
  return tiles;
}

// Pixels of the panel in these tiles; the padding does not count.
std::uint64_t pixels_in(const std::vector<std::uint32_t>& tiles, const PanelEye& eye) {
  std::uint64_t pixels = 0;
  for (const std::uint32_t tile : tiles) {
    const int left = static_cast<int>(tile & 0xffff) * tile_width_px;
    const int top = static_cast<int>(tile >> 16) * tile_height_px;
    pixels += static_cast<std::uint64_t>(std::min(tile_width_px, eye.width_px - left)) *
              static_cast<std::uint64_t>(std::min(tile_height_px, eye.height_px - top));
  }
  return pixels;
}

}  // namespace

gpu::KernelDescription compose_display_kernel(const DisplayParts& parts) {
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(parts.kernels_folder / "display_main.comp");
  kernel.resolve = gpu::chain_resolvers({parts.stages, gpu::directory_resolver({parts.glsl_folder})});
  kernel.constants = parts.constants;
  kernel.defines.emplace_back(lens_define(parts.lens.kind), "1");
  if (parts.lens.one_fetch)
    kernel.defines.emplace_back("BRACE_ONE_FETCH", "1");
  else if (parts.lens.one_centre)
    kernel.defines.emplace_back("BRACE_ONE_CENTRE", "1");
  if (parts.cell_poses) kernel.defines.emplace_back("BRACE_CELL_POSES", "1");
  if (parts.counters) kernel.defines.emplace_back("BRACE_COUNTERS", "1");
  return kernel;
}

PanelTarget::PanelTarget(const gpu::Device& device, const PanelEye& eye, const SourcePicture& source,
                         bool skip_hidden)
    : width_px_(eye.width_px), height_px_(eye.height_px), params_(display_params(eye, source)) {
  pitch_px_ = round_up(width_px_, tile_width_px);
  const int rows = round_up(height_px_, tile_height_px);
  std::vector<std::uint32_t> tiles = skip_hidden ? visible_tiles(eye) : all_tiles(eye);
  pixels_written_ = pixels_in(tiles, eye);
  tile_count_ = static_cast<std::uint32_t>(tiles.size());
  if (tiles.empty()) tiles.push_back(0);  // a buffer cannot be empty; nothing is dispatched then

  const auto bytes = static_cast<std::uint64_t>(pitch_px_) * static_cast<std::uint64_t>(rows) * 4;
  image_ = gpu::Buffer(device, "panel image", bytes, gpu::Memory::device);
  params_buffer_ = gpu::Buffer(device, "display parameters", sizeof(params_), gpu::Memory::upload);
  tiles_ = gpu::Buffer(device, "panel tiles", tiles.size() * 4, gpu::Memory::device);
  tile_texels_ = gpu::TexelBuffer(device, tiles_, gpu::Format::r32_uint);
  gpu::upload_values<std::uint32_t>(device, tiles_, tiles);
  gpu::upload_values<BraceDisplayParams>(device, params_buffer_, std::span(&params_, 1));
  gpu::CommandList clear(device, "clear the panel");
  clear.fill(image_, 0xff000000u);
  gpu::submit_and_wait(clear);
}

void PanelTarget::set_poses(const gpu::Device& device, const Pose& world_from_old_eye,
                            const Pose& world_from_new_eye) {
  set_poses(device, world_from_old_eye, ScanEye{world_from_new_eye, world_from_new_eye});
}

void PanelTarget::set_poses(const gpu::Device& device, const Pose& world_from_old_eye,
                            const ScanEye& new_eye) {
  brace::set_poses(params_, world_from_old_eye, new_eye);
  params_.old_from_new[0][3] = static_cast<float>(scene_range_.nearest_m);
  params_.old_from_new[1][3] = static_cast<float>(scene_range_.farthest_m);
  gpu::upload_values<BraceDisplayParams>(device, params_buffer_, std::span(&params_, 1));
}

ImageRgba8 PanelTarget::read(const gpu::Device& device) const {
  std::vector<Rgba8> padded(image_.size_bytes() / 4);
  gpu::download_values<Rgba8>(device, image_, padded);
  ImageRgba8 image(width_px_, height_px_);
  for (int y = 0; y < height_px_; ++y)
    std::copy_n(padded.begin() + static_cast<std::ptrdiff_t>(y) * pitch_px_, width_px_,
                image.pixels.begin() + static_cast<std::ptrdiff_t>(y) * width_px_);
  return image;
}

DisplayPipeline::DisplayPipeline(const gpu::Device& device, const gpu::KernelDescription& kernel,
                                 const gpu::CompileOptions& options)
    : pipeline_(gpu::make_pipeline(device, kernel, options)) {
  if (!pipeline_.uses(DisplaySlot::counters)) return;
  counters_ = gpu::Buffer(device, "display counters", 2 * sizeof(std::uint32_t), gpu::Memory::readback);
  reset_counters(device);
}

void DisplayPipeline::record(gpu::CommandList& commands, const PanelTarget& target,
                             const gpu::TexelBuffer& source, std::span<const gpu::Binding> more) const {
  constexpr std::size_t own_count = 5, bindings_max = 16;
  BRACE_CHECK(more.size() <= bindings_max - own_count);
  if (target.tile_count_ == 0) return;
  std::array<gpu::Binding, bindings_max> bindings{gpu::bind(DisplaySlot::params, target.params_buffer_),
                                                  gpu::bind(DisplaySlot::source_image, source),
                                                  gpu::bind(DisplaySlot::panel_image, target.image_),
                                                  gpu::bind(DisplaySlot::panel_tiles, target.tile_texels_)};
  std::size_t count = own_count - 1;
  if (counters_) bindings[count++] = gpu::bind(DisplaySlot::counters, counters_);
  for (const gpu::Binding& binding : more)
    bindings[count++] = binding;
  commands.dispatch(pipeline_, std::span(bindings).first(count), {}, {target.tile_count_, 1, 1});
}

DisplayPipeline::Counts DisplayPipeline::counted(const gpu::Device& device) const {
  std::array<std::uint32_t, 2> counts{};
  if (counters_) gpu::download_values<std::uint32_t>(device, counters_, counts);
  return {counts[0], counts[1]};
}

void DisplayPipeline::reset_counters(const gpu::Device& device) const {
  const std::array<std::uint32_t, 2> zero{};
  if (counters_) gpu::upload_values<std::uint32_t>(device, counters_, zero);
}

}  // namespace brace
