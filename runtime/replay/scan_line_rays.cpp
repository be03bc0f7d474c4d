#include "runtime/replay/scan_line_rays.hpp"

#include <span>
#include <vector>
namespace brace {

namespace {

constexpr std::uint32_t kFractionsSlot = 24, kLastSlot = 25;  // scan_line_rays.glsl has the same

}  // namespace

gpu::Buffer scan_fraction_buffer(const gpu::Device& device, const Headset& headset, sim::Eye eye) {
  const std::vector<float> fractions = scan_fractions(panel_eye(headset, eye), source_picture(headset, eye));
  gpu::Buffer buffer(device, "scan fractions", fractions.size() * sizeof(float), gpu::Memory::upload);
  gpu::upload_values<float>(device, buffer, fractions);
  return buffer;
}

ScanLineRays::ScanLineRays(const gpu::Device& device, const Headset& headset) : device_(device) {
  for (const sim::Eye eye : sim::all_eyes) {
    const auto i = static_cast<std::size_t>(eye);
    fractions_[i] = scan_fraction_buffer(device, headset, eye);
    last_[i] = gpu::Buffer(device, "eye at the last line", sizeof(BraceEyeParams), gpu::Memory::upload);
  }
}

PipelineStage ScanLineRays::opening(PipelineStage full_rate, const std::filesystem::path& data_folder) {
  full_rate.stage.glsl_source = data_folder / "kernels" / "scan_line_rays.glsl";
  return full_rate;
}

void ScanLineRays::set_last(sim::Eye eye, const EyeView& last, const VolumeInfo& volume,
                            const VolumePlacement& placement) const {
  const BraceEyeParams params = eye_params(last, volume, placement);
  gpu::upload_values<BraceEyeParams>(device_, last_[static_cast<std::size_t>(eye)], std::span(&params, 1));
}

std::array<gpu::Binding, 2> ScanLineRays::bindings(sim::Eye eye) const {
  const auto i = static_cast<std::size_t>(eye);
  return {gpu::bind(kFractionsSlot, fractions_[i]), gpu::bind(kLastSlot, last_[i])};
}

}  // namespace brace
