#include "gpu/display_reference.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "runtime/host/stage_glsl.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

Picture noise_picture(int width_px, int height_px, const sim::FovTangents& fov) {
  std::mt19937 random(11);
  Picture picture{{width_px, height_px, fov}, {}};
  picture.pixels.resize(static_cast<std::size_t>(width_px * height_px));
  for (std::uint32_t& pixel : picture.pixels)
    pixel = static_cast<std::uint32_t>(random());
  return picture;
}

double directional_value(const glm::dvec3& world_direction, std::size_t channel) {
  const glm::dvec3 d = glm::normalize(world_direction);
  return 127.5 + 120.0 * std::sin(3.0 * d.x + 2.0 * static_cast<double>(channel)) * std::cos(4.0 * d.y + d.z);
}

Picture directional_picture(int width_px, int height_px, const sim::FovTangents& fov,
                            const Pose& world_from_eye) {
  Picture picture{{width_px, height_px, fov}, {}};
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      const glm::dvec2 t = sim::target_uv_to_tangents(fov, {(x + 0.5) / width_px, (y + 0.5) / height_px});
      std::uint32_t pixel = 0xff000000u;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double value = directional_value(world_from_eye.orientation * glm::dvec3(t, -1.0), channel);
        pixel |= static_cast<std::uint32_t>(std::lround(value)) << (8 * channel);
      }
      picture.pixels.push_back(pixel);
    }
  return picture;
}

WarpReference no_warp() {
  return [](glm::dvec2 tangents) { return std::optional(tangents); };
}

WarpReference quad_warp(const Pose& world_from_old_eye, const Pose& world_from_new_eye, double far_plane_m) {
  return [=](glm::dvec2 tangents) -> std::optional<glm::dvec2> {
    const glm::dvec3 world = transform_point(world_from_new_eye, glm::dvec3(tangents, -1.0) * far_plane_m);
    const glm::dvec3 old = transform_point(inverse(world_from_old_eye), world);
    if (-old.z <= 1e-4 * far_plane_m) return std::nullopt;
    return glm::dvec2(old.x, old.y) / -old.z;
  };
}

namespace {

bool near(double a, double b) {
  return std::abs(a - b) < 2e-3;
}

double bilinear(const Picture& picture, double x, double y, std::size_t channel) {
  const auto at = [&](double px, double py) {
    return static_cast<double>(
        picture.value(static_cast<int>(std::clamp(px, 0.0, picture.shape.width_px - 1.0)),
                      static_cast<int>(std::clamp(py, 0.0, picture.shape.height_px - 1.0)), channel));
  };
  const double left = std::floor(x), top = std::floor(y), fx = x - left, fy = y - top;
  return (1 - fy) * ((1 - fx) * at(left, top) + fx * at(left + 1, top)) +
         fy * ((1 - fx) * at(left, top + 1) + fx * at(left + 1, top + 1));
}

}  // namespace

PanelReference::PanelReference(const PanelEye& eye, const Picture& picture, WarpReference warp)
    : eye_(eye), picture_(picture), warp_(std::move(warp)) {
  for (const sim::Channel channel : sim::all_channels)
    usable_[static_cast<std::size_t>(channel)] = sim::usable_radius(eye.lens, channel);
}

ReferencePixel PanelReference::at(std::size_t channel, int x, int y) const {
  const PanelEye& eye = eye_;
  ReferencePixel result;
  result.covered = false;
  const glm::dvec2 uv((x + 0.5) / eye.width_px, (y + 0.5) / eye.height_px);
  const double usable = usable_[channel];
  const glm::dvec2 from_centre = (uv - eye.lens.rgb[channel].centre_uv) * eye.lens.panel_size_units;
  result.on_edge = std::abs(glm::length(from_centre) - usable) < 1e-5;
  const auto tangents = sim::panel_to_tangents(eye.lens, static_cast<sim::Channel>(channel), usable, uv);
  if (!tangents) return result;
  const glm::dvec2 seen = sim::tangents_to_target_uv(eye.fov, *tangents);
  for (const double edge : {seen.x, seen.y})
    result.on_edge |= std::abs(edge * (1 - edge)) < 1e-5;
  if (seen.x < 0 || seen.x > 1 || seen.y < 0 || seen.y > 1) return result;

  const int width = picture_.shape.width_px, height = picture_.shape.height_px;
  const std::optional<glm::dvec2> source_tangents = warp_(*tangents);
  result.uncovered = true;
  if (!source_tangents) return result;
  const glm::dvec2 source_uv = sim::tangents_to_target_uv(picture_.shape.fov, *source_tangents);
  const double sx = source_uv.x * width - 0.5, sy = source_uv.y * height - 0.5;
  result.on_edge |= near(sx, -0.5) || near(sx, width - 0.5) || near(sy, -0.5) || near(sy, height - 0.5);
  if (sx < -0.5 || sy < -0.5 || sx > width - 0.5 || sy > height - 0.5) return result;
  result.uncovered = false;
  result.covered = true;
  result.value = bilinear(picture_, sx, sy, channel);
  return result;
}

gpu::KernelDescription DisplayRun::kernel(const LensTraits& lens) const {
  const std::filesystem::path root = BRACE_SOURCE_DIR;
  DisplayParts parts;
  parts.glsl_folder = root / "plugins/abi/glsl";
  parts.kernels_folder = root / "runtime/display/kernels";
  parts.lens = lens;
  parts.counters = counters;
  PipelineStage stage{read_stage_manifest(root / "stages/warp" / warp / "stage.toml"), {}};
  for (const StageParameter& parameter : stage.stage.parameters) {
    const auto given = parameters.find(parameter.name);
    stage.values.push_back(given == parameters.end() ? parameter.default_value : given->second);
  }
  const PipelineStage* const stages[] = {&stage};
  StageGlsl glsl = stage_glsl(stages);
  parts.stages = std::move(glsl.resolve);
  parts.constants = std::move(glsl.constants);
  return compose_display_kernel(parts);
}

DisplayRun::Result DisplayRun::show(const PanelEye& eye, const Picture& picture,
                                    std::span<const float> depths_m) const {
  const DisplayPipeline pipeline(device, kernel(traits.value_or(lens_traits(eye.lens))));
  PanelTarget target(device, eye, picture.shape, skip_hidden);
  target.set_poses(device, world_from_old_eye,
                   new_eye_by_line.value_or(ScanEye{world_from_new_eye, world_from_new_eye}));
  const gpu::Buffer source(device, "source", picture.pixels.size() * 4, gpu::Memory::device);
  gpu::upload_values<std::uint32_t>(device, source, picture.pixels);
  const gpu::TexelBuffer texels(device, source, gpu::Format::r32_uint);
  gpu::Buffer depth;
  gpu::TexelBuffer depth_texels;
  std::vector<gpu::Binding> more;
  if (pipeline.uses_depth()) {
    BRACE_CHECK(depths_m.size() == picture.pixels.size());
    depth = gpu::Buffer(device, "depth", depths_m.size_bytes(), gpu::Memory::device);
    gpu::upload_values<float>(device, depth, depths_m);
    depth_texels = gpu::TexelBuffer(device, depth, gpu::Format::r32_float);
    more.push_back(gpu::bind(DisplaySlot::source_depth, depth_texels));
  }
  gpu::CommandList commands(device, "display");
  pipeline.record(commands, target, texels, more);
  gpu::submit_and_wait(commands);
  return {target.read(device), target.pixels_written(), pipeline.counted(device)};
}

void expect_like_reference(const ImageRgba8& image, const PanelEye& eye, const Picture& picture,
                           const WarpReference& warp, const std::string& what) {
  const PanelReference reference(eye, picture, warp);
  int differing = 0, skipped = 0, covered = 0;
  for (int y = 0; y < eye.height_px; ++y)
    for (int x = 0; x < eye.width_px; ++x)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const ReferencePixel expected = reference.at(channel, x, y);
        skipped += expected.on_edge;
        if (expected.on_edge) continue;
        covered += expected.covered;
        const Rgba8 pixel = image.at(x, y);
        const std::uint8_t shown[] = {pixel.r, pixel.g, pixel.b};
        if (std::abs(shown[channel] - expected.value) <= 1.0 && pixel.a == 255) continue;
        if (differing++ == 0)
          ADD_FAILURE() << what << ": pixel " << x << ", " << y << " channel " << channel << " is "
                        << int{shown[channel]} << ", expected " << expected.value;
      }
  EXPECT_EQ(differing, 0) << what;
  EXPECT_LT(skipped, eye.width_px * eye.height_px / 100) << what;
  EXPECT_GT(covered, 0) << what;
}

}  // namespace brace
