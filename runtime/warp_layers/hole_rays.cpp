#include "runtime/warp_layers/hole_rays.hpp"

#include <array>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::uint32_t kMarkedSlot = 34;  // holes.comp has the same

gpu::ComputePipeline holes_pipeline(const gpu::Device& device, const NovelView::Folders& folders, bool mask) {
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folders.kernels / "holes.comp");
  kernel.resolve = gpu::directory_resolver({folders.glsl});
  if (mask) kernel.defines.emplace_back("BRACE_HOLES_MASK", "1");
  return gpu::make_pipeline(device, kernel);
}

}  // namespace

HoleRays::HoleRays(const gpu::Device& device, const CastKernels& kernels, int width_px, int height_px,
                   const NovelView::Folders& folders)
    : device_(device),
      width_px_(width_px),
      height_px_(height_px),
      pipeline_(device, kernels),
      mask_(holes_pipeline(device, folders, true)),
      merge_(holes_pipeline(device, folders, false)),
      holes_(device, "holes",
             static_cast<std::uint64_t>(width_px) * static_cast<std::uint64_t>(height_px) * 4,
             gpu::Memory::device) {}

void HoleRays::record(gpu::CommandList& commands, const CastPipeline::Resources& resources) const {
  const CastArea pixels{0, 0, width_px_, height_px_};
  const BraceArea area{{0, 0},
                       {static_cast<std::uint32_t>(width_px_), static_cast<std::uint32_t>(height_px_)}};
  const std::array bindings = {gpu::bind(CastSlot::eye, resources.target.params),
                               gpu::bind(CastSlot::ray_entry, resources.rays.entries),
                               gpu::bind(CastSlot::result_colour, resources.rays.colours),
                               gpu::bind(CastSlot::result_depth, resources.rays.depths_m),
                               gpu::bind(CastSlot::eye_image, resources.target.image),
                               gpu::bind(CastSlot::eye_depth, resources.target.depth),
                               gpu::bind(kMarkedSlot, holes_)};
  const auto run = [&](const gpu::ComputePipeline& pipeline) {
    const auto groups = [](int px) { return static_cast<std::uint32_t>((px + 7) / 8); };
    commands.dispatch(pipeline, bindings, std::as_bytes(std::span(&area, 1)),
                      {groups(width_px_), groups(height_px_), 1});
    commands.barrier();
  };
  pipeline_.record_opening(commands, resources, pixels);
  commands.barrier();
  run(mask_);
  pipeline_.record_cast(commands, resources, pixels);
  commands.barrier();
  run(merge_);
}

}  // namespace brace
