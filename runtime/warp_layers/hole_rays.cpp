#include "runtime/warp_layers/hole_rays.hpp"

#include <vector>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr std::uint32_t kMarkedSlot = 34, kColoursSlot = 35, kDepthsSlot = 36;  // holes.comp has the same

gpu::ComputePipeline holes_pipeline(const gpu::Device& device, const NovelView::Folders& folders, bool mask,
                                    HoleRays::Of of) {
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(folders.kernels / "holes.comp");
  kernel.resolve = gpu::directory_resolver({folders.glsl});
  if (mask) kernel.defines.emplace_back("BRACE_HOLES_MASK", "1");
  if (of == HoleRays::Of::atlas) kernel.defines.emplace_back("BRACE_HOLES_OF_ATLAS", "1");
  return gpu::make_pipeline(device, kernel);
}

gpu::Buffer per_ray(const gpu::Device& device, const char* name, int across, int down, std::uint64_t bytes) {
  return {device, name, static_cast<std::uint64_t>(across) * static_cast<std::uint64_t>(down) * bytes,
          gpu::Memory::device};
}

}  // namespace

HoleRays::HoleRays(const gpu::Device& device, const CastKernels& kernels, int across, int down,
                   const NovelView::Folders& folders, Of of)
    : device_(device),
      across_(across),
      down_(down),
      of_(of),
      pipeline_(device, kernels),
      mask_(holes_pipeline(device, folders, true, of)),
      merge_(holes_pipeline(device, folders, false, of)),
      holes_(per_ray(device, "holes", across, down, 4)) {
  if (of == Of::pixels) return;
  colours_ = per_ray(device, "composed colours", across, down, 16);
  depths_m_ = per_ray(device, "composed depths", across, down, 4);
}

CastArea HoleRays::area(const CastPipeline::Resources& resources) const {
  if (of_ == Of::pixels) return {0, 0, across_, down_};
  return {0, 0, resources.rays_across(), resources.rays_down()};
}

void HoleRays::run(gpu::CommandList& commands, const gpu::ComputePipeline& pipeline,
                   const CastPipeline::Resources& resources) const {
  const CastArea rays = area(resources);
  BRACE_CHECK(rays.width * rays.height <= across_ * down_);
  const BraceArea params{{0, 0},
                         {static_cast<std::uint32_t>(rays.width), static_cast<std::uint32_t>(rays.height)}};
  std::vector<gpu::Binding> bindings = {gpu::bind(CastSlot::eye, resources.target.params),
                                        gpu::bind(CastSlot::ray_entry, resources.rays.entries),
                                        gpu::bind(CastSlot::result_colour, resources.rays.colours),
                                        gpu::bind(CastSlot::result_depth, resources.rays.depths_m),
                                        gpu::bind(CastSlot::eye_image, resources.target.image),
                                        gpu::bind(CastSlot::eye_depth, resources.target.depth),
                                        gpu::bind(kMarkedSlot, holes_)};
  if (of_ == Of::atlas) {
    bindings.push_back(gpu::bind(kColoursSlot, colours_));
    bindings.push_back(gpu::bind(kDepthsSlot, depths_m_));
  }
  commands.dispatch(pipeline, bindings, std::as_bytes(std::span(&params, 1)),
                    pipeline.groups_for(rays.width, rays.height));
  commands.barrier();
}

void HoleRays::record_opening(gpu::CommandList& commands, const CastPipeline::Resources& resources) const {
  pipeline_.record_opening(commands, resources, area(resources));
  commands.barrier();
  run(commands, mask_, resources);
}

void HoleRays::record_closing(gpu::CommandList& commands, const CastPipeline::Resources& resources) const {
  run(commands, merge_, resources);
  if (of_ == Of::pixels) return;
  pipeline_.record_closing(commands, resources,
                           {0, 0, resources.target.width_px, resources.target.height_px});
  commands.barrier();
}

}  // namespace brace
