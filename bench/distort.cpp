#include "bench/distort.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <span>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <stdlib.h>

#include "bench/median.hpp"
#include "hmd_sim/device_profile.hpp"
#include "runtime/display/display_pipeline.hpp"

namespace brace {
namespace {

constexpr int panel_width_px = 960, panel_height_px = 1080;
constexpr double source_scale = 1.4;
constexpr int warm_up = 3;

// As published, on 2 cores of another machine; lavapipe and CPU.
constexpr double rival_runtime_ns_per_px = 16.9;
constexpr double rival_cpu_ns_per_px_min = 1.5, rival_cpu_ns_per_px_max = 2.3;
constexpr double target_ns_per_px = 8.0;

struct CaseSetup {
  const char* name;
  const char* help;
  const char* warp;
  bool skip_hidden;
  bool one_polynomial;  // the green one for all channels
  bool has_lens;
};

constexpr CaseSetup setups[] = {
    {"distort", "3 channels, every panel pixel", "none", false, false, true},
    {"distort_visible", "3 channels, hidden tiles left out", "none", true, false, true},
    {"distort_quad", "3 channels, every panel pixel, late warp", "quad", false, false, true},
    {"distort_grey", "one polynomial for all channels", "none", false, true, true},
    {"no_lens", "resampling alone", "none", false, false, false},
};

struct RunningCase {
  DisplayPipeline pipeline;
  std::array<PanelTarget, 2> targets;
  gpu::CommandList commands;
  std::vector<double> device_ns, cpu_ns;
};

double cpu_time_ns() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e9 + static_cast<double>(time.tv_nsec);
}

gpu::KernelDescription kernel_of(const std::filesystem::path& data, const CaseSetup& setup, LensTraits lens) {
  DisplayParts parts;
  parts.glsl_folder = data / "glsl";
  parts.kernels_folder = data / "kernels";
  parts.lens = lens;
  const std::filesystem::path snippet =
      data / "stages" / "warp" / setup.warp / (std::string(setup.warp) + ".glsl");
  parts.stages = [snippet](std::string_view name) -> std::optional<gpu::GlslSource> {
    if (name == "stage/warp.glsl") return gpu::read_glsl(snippet);
    if (name == "stage/parameters.glsl")
      return gpu::GlslSource{std::string(name), "const float warp_far_plane_m = 100.0;\n"};
    return std::nullopt;
  };
  return compose_display_kernel(parts);
}

PanelEye panel_eye(const sim::DeviceProfile& profile, sim::Eye which, const CaseSetup& setup) {
  const sim::EyeProfile& eye = profile.eye(which);
  PanelEye panel{panel_width_px, panel_height_px, eye.lens, eye.fov};
  if (!setup.has_lens) panel.lens = sim::identity_lens(eye.fov);
  if (setup.one_polynomial) panel.lens.rgb[0] = panel.lens.rgb[2] = panel.lens.rgb[1];
  return panel;
}

SourcePicture source_of(const PanelEye& eye) {
  return {static_cast<int>(std::lround(panel_width_px * source_scale)),
          static_cast<int>(std::lround(panel_height_px * source_scale)), eye.fov};
}

std::vector<std::uint32_t> smooth_picture(int width_px, int height_px) {
  std::vector<std::uint32_t> pixels;
  pixels.reserve(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x)
      pixels.push_back(0xff000000u | static_cast<std::uint32_t>((x / 8 & 255) | (y / 8 & 255) << 8) |
                       static_cast<std::uint32_t>(((x + y) / 8 & 255) << 16));
  return pixels;
}

RunningCase start(const gpu::Device& device, const DistortBenchOptions& options, const CaseSetup& setup,
                  const sim::DeviceProfile& profile, const gpu::TexelBuffer& source) {
  const std::array<PanelEye, 2> eyes{panel_eye(profile, sim::Eye::left, setup),
                                     panel_eye(profile, sim::Eye::right, setup)};
  const LensTraits lens = common_traits(lens_traits(eyes[0].lens), lens_traits(eyes[1].lens));
  RunningCase running;
  running.pipeline = DisplayPipeline(device, kernel_of(options.data_folder, setup, lens));
  running.commands = gpu::CommandList(device, setup.name);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    running.targets[eye] = PanelTarget(device, eyes[eye], source_of(eyes[eye]), setup.skip_hidden);
    // Two degrees of yaw within a frame: what a warp has to do when a head turns quickly.
    running.targets[eye].set_poses(device, {}, Pose{quat_exp({0.0, 0.035, 0.0}), {}});
  }
  running.commands.begin_timing("display");
  for (const PanelTarget& target : running.targets)
    running.pipeline.record(running.commands, target, source);
  running.commands.end_timing();
  return running;
}

DistortBenchCase finish(const CaseSetup& setup, const RunningCase& running,
                        const DistortBenchResult& result) {
  const auto pixels = static_cast<double>(result.panel_pixels);
  DistortBenchCase done;
  done.name = setup.name;
  done.help = setup.help;
  done.device_ns_per_px_median = median(running.device_ns) / pixels;
  done.device_ns_per_px_min = *std::min_element(running.device_ns.begin(), running.device_ns.end()) / pixels;
  if (result.is_software) done.cpu_ns_per_px_median = median(running.cpu_ns) / pixels;
  const auto written =
      static_cast<double>(running.targets[0].pixels_written() + running.targets[1].pixels_written());
  done.pixels_written_ratio = written / pixels;
  done.gb_per_s = 4.0 * (static_cast<double>(result.source_pixels) + written) / median(running.device_ns);
  return done;
}

}  // namespace

DistortBenchResult bench_distort(const DistortBenchOptions& options) {
  const gpu::Device device(options.device);
  const sim::DeviceProfile profile = sim::find_device_profile(options.data_folder / "devices", "htc-vive");
  DistortBenchResult result;
  result.device = device.info().name;
  result.is_software = device.limits().is_software;
  result.host_cores = std::thread::hardware_concurrency();
  if (getloadavg(&result.host_load, 1) != 1) result.host_load = 0;
  result.repetitions = std::max(1, options.repetitions);
  result.panel_pixels = std::int64_t{2} * panel_width_px * panel_height_px;
  const SourcePicture shape = source_of(panel_eye(profile, sim::Eye::left, setups[0]));
  result.source_pixels = std::int64_t{2} * shape.width_px * shape.height_px;

  const std::vector<std::uint32_t> pixels = smooth_picture(shape.width_px, shape.height_px);
  const gpu::Buffer source(device, "eye frame", pixels.size() * 4, gpu::Memory::device);
  gpu::upload_values<std::uint32_t>(device, source, pixels);
  const gpu::TexelBuffer texels(device, source, gpu::Format::r32_uint);
  std::vector<RunningCase> running;
  for (const CaseSetup& setup : setups)
    running.push_back(start(device, options, setup, profile, texels));
  for (int i = 0; i < warm_up + result.repetitions; ++i)
    for (RunningCase& one : running) {
      const double cpu_before_ns = cpu_time_ns();
      const std::int64_t ns = gpu::device_ns(gpu::submit_and_wait(one.commands), "display");
      if (i < warm_up) continue;
      one.device_ns.push_back(static_cast<double>(ns));
      one.cpu_ns.push_back(cpu_time_ns() - cpu_before_ns);
    }
  for (std::size_t i = 0; i < running.size(); ++i)
    result.cases.push_back(finish(setups[i], running[i], result));
  return result;
}

std::string to_text(const DistortBenchResult& result) {
  std::string text = fmt::format(
      "Lens distortion, HTC Vive, 1920 x 1080 output pixels from {:.1f} million source pixels\n"
      "on {}, {} host cores at a load of {:.1f}, median of {}\n\n"
      "{:<16} {:>9} {:>9} {:>9} {:>7} {:>8}\n",
      static_cast<double>(result.source_pixels) * 1e-6, result.device, result.host_cores, result.host_load,
      result.repetitions, "", "ns/pixel", "minimum", "CPU ns", "GB/s", "written");
  for (const DistortBenchCase& one : result.cases) {
    const std::string cpu = result.is_software ? fmt::format("{:.2f}", one.cpu_ns_per_px_median) : "-";
    text += fmt::format("{:<16} {:>9.2f} {:>9.2f} {:>9} {:>7.1f} {:>7.0f}%  {}\n", one.name,
                        one.device_ns_per_px_median, one.device_ns_per_px_min, cpu, one.gb_per_s,
                        100.0 * one.pixels_written_ratio, one.help);
  }
  const double ours = result.cases.front().device_ns_per_px_median;
  text += fmt::format(
      "\nPublished elsewhere, not measured here:\n"
      "  an open-source runtime's distortion on lavapipe, 2 cores   {:.1f} ns/pixel, {:.2f} x ours\n"
      "  a hand-vectorised CPU time-warp                       {:.1f} - {:.1f} ns/pixel, {:.2f} - {:.2f} x "
      "ours\n"
      "Target at most {:.0f} ns/pixel: {}",
      rival_runtime_ns_per_px, rival_runtime_ns_per_px / ours, rival_cpu_ns_per_px_min,
      rival_cpu_ns_per_px_max, rival_cpu_ns_per_px_min / ours, rival_cpu_ns_per_px_max / ours,
      target_ns_per_px, ours <= target_ns_per_px ? "met" : "not met in this run");
  return text;
}

std::string to_json(const DistortBenchResult& result) {
  using nlohmann::ordered_json;
  ordered_json cases = ordered_json::array();
  for (const DistortBenchCase& one : result.cases) {
    ordered_json entry = {{"name", one.name},
                          {"help", one.help},
                          {"device_ns_per_px_median", one.device_ns_per_px_median},
                          {"device_ns_per_px_min", one.device_ns_per_px_min},
                          {"gb_per_s", one.gb_per_s},
                          {"pixels_written_ratio", one.pixels_written_ratio}};
    if (result.is_software) entry["cpu_ns_per_px_median"] = one.cpu_ns_per_px_median;
    cases.push_back(std::move(entry));
  }
  const double ours = result.cases.front().device_ns_per_px_median;
  const ordered_json json = {
      {"bench", "distort"},
      {"device", result.device},
      {"host_cores", result.host_cores},
      {"host_load", result.host_load},
      {"repetitions", result.repetitions},
      {"panel_pixels", result.panel_pixels},
      {"source_pixels", result.source_pixels},
      {"cases", std::move(cases)},
      {"published",
       {{"runtime_on_lavapipe_ns_per_px", rival_runtime_ns_per_px},
        {"runtime_on_lavapipe_ratio", rival_runtime_ns_per_px / ours},
        {"cpu_time_warp_ns_per_px", {rival_cpu_ns_per_px_min, rival_cpu_ns_per_px_max}},
        {"cpu_time_warp_ratio", {rival_cpu_ns_per_px_min / ours, rival_cpu_ns_per_px_max / ours}}}},
      {"target_ns_per_px", target_ns_per_px},
      {"target_met", ours <= target_ns_per_px}};
  return json.dump(2);
}

}  // namespace brace
