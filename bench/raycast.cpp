#include "bench/raycast.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "base/error.hpp"
#include "bench/median.hpp"
#include "bench/raycast_rig.hpp"
#include "bench/raycast_rivals.hpp"
#include "runtime/raycast/path_choice.hpp"

namespace brace {

namespace {

double minimum(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::min_element(values.begin(), values.end());
}

/// One renderer with a case per transfer function.
class RendererBench {
 public:
  RendererBench(const gpu::Device& device, const RaycastBenchOptions& options, const RaycastScene& scene,
                const RigRenderer& renderer)
      : device_(device), rig_(device, options.data_folder, scene, renderer) {
    for (const RaycastScene::Transfer& transfer : scene.transfers)
      cases_.push_back(prepare(renderer, transfer));
    for (std::size_t i = 0; i < cases_.size(); ++i)
      cases_[i].result.samples = rig_.count(i).samples;  // warms up, too
  }

  void run(int repetitions) {
    for (int i = 0; i < repetitions; ++i) {
      for (std::size_t c = 0; c < cases_.size(); ++c)
        measure(c);
    }
  }

  void finish(std::vector<RaycastBenchCase>& to) const {
    for (const Running& one : cases_) {
      RaycastBenchCase done = one.result;
      done.frame_ms_median = median(one.wall_ms);
      done.frame_ms_min = minimum(one.wall_ms);
      done.samples_per_s = static_cast<double>(done.samples) / (1e-3 * done.frame_ms_median);
      if (device_.limits().is_software) done.cpu_ms_min = minimum(one.cpu_ms);
      to.push_back(done);
    }
  }

 private:
  struct Running {
    RaycastBenchCase result;
    std::vector<double> wall_ms, cpu_ms;
  };

  static Running prepare(const RigRenderer& renderer, const RaycastScene::Transfer& transfer) {
    const VolumePath path = renderer.scene_volume.volume.path();
    Running one;
    one.result.renderer =
        renderer.native != nullptr ? renderer.native->id() : fmt::format("cast/dvr, {}", to_string(path));
    if (renderer.skip != SkipKind::none)
      one.result.renderer += fmt::format(", skip/{}", to_string(renderer.skip));
    one.result.transfer = transfer.name;
    one.result.skips = renderer.skip != SkipKind::none;
    return one;
  }

  void measure(std::size_t transfer) {
    const double cpu_before_ms = process_cpu_ms();
    const auto begin = std::chrono::steady_clock::now();
    rig_.cast_frame(transfer);
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
    cases_[transfer].wall_ms.push_back(wall.count());
    cases_[transfer].cpu_ms.push_back(process_cpu_ms() - cpu_before_ms);
  }

  const gpu::Device& device_;
  RaycastRig rig_;
  std::vector<Running> cases_;
};

}  // namespace

RaycastBenchResult bench_raycast(const RaycastBenchOptions& options) {
  const gpu::Device device(options.device);
  const RaycastScene scene = make_raycast_scene(options.size_px, options.size_px);
  RaycastBenchResult result;
  result.device = device.info().name;
  result.host_cores = std::thread::hardware_concurrency();
  result.host_load = host_load();
  result.repetitions = options.repetitions;
  result.size_px = options.size_px;

  gpu::Measurements measurements;
  const VolumeInfo info = open_scene_volume()->info();
  const SceneVolume chosen(
      device, {}, choose_volume_path(device, info, VolumePath::automatic, options.data_folder, measurements));
  const bool is_packed = chosen.volume.path() == VolumePath::packed;
  const SceneVolume other(
      device, {},
      choose_volume_path(info, device.limits(), is_packed ? VolumePath::sampler : VolumePath::packed));
  result.zero_voxels_ratio = chosen.share_up_to(0);
  result.path_reason = chosen.volume.path_reason();
  if (const std::string& figures = chosen.volume.path_figures(); !figures.empty())
    result.path_reason += "; " + figures;

  std::vector<RigRenderer> renderers = {{chosen}, {other}, {chosen, SkipKind::distance_map}};
  if (const StageInfo* native = find_native(options.stages)) {
    renderers.push_back({chosen, SkipKind::none, native});
    renderers.push_back({chosen, SkipKind::distance_map, native});
  } else {
    result.notes.emplace_back("cast/native was not measured: its plug-in was not found");
  }
  std::vector<std::unique_ptr<RendererBench>> ours;
  for (const RigRenderer& renderer : renderers)
    ours.push_back(std::make_unique<RendererBench>(device, options, scene, renderer));

  const int before = (options.repetitions + 1) / 2;
  for (const auto& bench : ours)
    bench->run(before);
  std::vector<RaycastBenchCase> rivals;
  if (options.rivals) measure_raycast_rivals(options, scene, rivals, result.notes);
  for (const auto& bench : ours)
    bench->run(options.repetitions - before);
  for (const auto& bench : ours)
    bench->finish(result.cases);
  result.cases.insert(result.cases.end(), rivals.begin(), rivals.end());
  return result;
}

}  // namespace brace
