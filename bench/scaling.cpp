#include "bench/scaling.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <thread>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "bench/raycast_rig.hpp"
#include "bench/tile_schedule.hpp"
#include "runtime/raycast/path_choice.hpp"

namespace brace {

namespace {

constexpr int native_tile_px = 32;  // as plugins/native_cast has it

// What work costs cast/native in samples: the times of tiles on one thread, fitted by least squares, gave 1.2
// to 2 for a look-up and up to 16 for a ray.
constexpr double skip_step_cost = 2.0;
constexpr double ray_cost = 10.0;

constexpr double patience_s = 10.0;  // after that no more repetitions

double counted_cost(const WorkCounts& counts) {
  return static_cast<double>(counts.samples) + skip_step_cost * static_cast<double>(counts.skip_steps) +
         ray_cost * static_cast<double>(counts.rays);
}

struct Cast {
  RaycastRig& rig;
  std::size_t transfer = 0;
};

/// The shortest of several, each run in turn so that what else the machine does meets all of them.
std::vector<RaycastRig::CastTime> shortest(int repetitions, const std::vector<Cast>& all) {
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<RaycastRig::CastTime> shortest(all.size(), {never, never});
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < repetitions; ++i) {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    if (spent.count() > patience_s) break;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const RaycastRig::CastTime time = all[k].rig.time_cast(all[k].transfer);
      shortest[k].ms = std::min(shortest[k].ms, time.ms);
      shortest[k].cpu_ms = std::min(shortest[k].cpu_ms, time.cpu_ms);
    }
  }
  return shortest;
}

/// Both transfer functions of a rig.
template <typename Row>
void time_rows(int repetitions, RaycastRig& rig, std::vector<Row>& rows) {
  std::vector<Cast> casts;
  for (std::size_t t = 0; t < rows.size(); ++t)
    casts.push_back({rig, t});
  const auto times = shortest(repetitions, casts);
  for (std::size_t t = 0; t < rows.size(); ++t) {
    rows[t].ms = times[t].ms;
    rows[t].cpu_ms = times[t].cpu_ms;
  }
}

const char* name_of(SkipKind skip) {
  return skip == SkipKind::none ? "" : ", distance map";
}

std::string text_of(const std::array<int, 3>& dims) {
  return fmt::format("{} x {} x {}", dims[0], dims[1], dims[2]);
}

int longest(const std::array<int, 3>& dims) {
  return *std::max_element(dims.begin(), dims.end());
}

/// The scene for a volume of this edge: absorption per voxel so that the picture stays that of 256 voxels.
RaycastScene scene_for(int edge_voxels, int width_px, int height_px) {
  RaycastScene scene = make_raycast_scene(width_px, height_px);
  const double scale = 256.0 / edge_voxels;
  scene.transfers = {{"T", scene_transfer("T", 20.0, scale)}, {"S", scene_transfer("S", 140.0, scale)}};
  return scene;
}

/// The longest edge is as long as the placement says.
double ray_distance_voxels(const RaycastScene& scene, int edge_voxels) {
  const double distance_m = glm::length(scene.eye.world_from_eye.position);
  const double pixel_m = distance_m * (scene.eye.tan_right - scene.eye.tan_left) / scene.eye.width_px;
  return pixel_m / scene.placement.size_m * edge_voxels;
}

class ScalingBench {
 public:
  ScalingBench(const ScalingBenchOptions& options, ScalingBenchResult& result)
      : options_(options), result_(result), device_(options.device), native_(find_native(options.stages)) {
    result.device = device_.info().name;
    if (native_ == nullptr) result.notes.emplace_back("cast/native was not measured: no plug-in was found");
  }

  void threads();
  void image();
  void volume();
  void empty();

 private:
  void say(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }

  VolumePathChoice path_of(const SceneBall& ball, VolumePath wanted = VolumePath::automatic) {
    return choose_volume_path(device_, open_scene_volume(ball)->info(), wanted, options_.data_folder,
                              measurements_);
  }

  SceneBall ball() const {
    SceneBall made;
    made.dims.fill(options_.edge_voxels);
    return made;
  }

  /// cast/native, where it is there, and cast/dvr.
  std::vector<const StageInfo*> casters() const {
    if (native_ == nullptr) return {nullptr};
    return {native_, nullptr};
  }

  static std::string name_of_renderer(const StageInfo* native, const SceneVolume& volume) {
    return native != nullptr ? native->id() : fmt::format("cast/dvr, {}", to_string(volume.volume.path()));
  }

  std::unique_ptr<RaycastRig> rig(const RaycastScene& scene, const RigRenderer& renderer) const {
    return std::make_unique<RaycastRig>(device_, options_.data_folder, scene, renderer);
  }

  void threads_of(const SceneVolume& volume, const RaycastScene& scene, SkipKind skip);
  void simulate(RaycastRig& rig, std::size_t transfer, const std::vector<CastArea>& tiles,
                ScalingThreadsRow& row) const;
  void volume_of(const SceneVolume& volume, bool is_chosen);
  void casts_of(const SceneVolume& volume, const StageInfo* native, bool is_chosen, bool same_distance);

  const ScalingBenchOptions& options_;
  ScalingBenchResult& result_;
  gpu::Device device_;
  gpu::Measurements measurements_;
  const StageInfo* native_;
};

void ScalingBench::threads() {
  if (native_ == nullptr) return;
  const SceneVolume volume(device_, ball(), path_of(ball()));
  for (const auto& picture : options_.thread_pictures) {
    const RaycastScene scene = scene_for(options_.edge_voxels, picture.width_px, picture.height_px);
    for (const SkipKind skip : {SkipKind::none, SkipKind::distance_map}) {
      threads_of(volume, scene, skip);
      say(fmt::format("threads: {} x {}{} done", picture.width_px, picture.height_px, name_of(skip)));
    }
  }
}

void ScalingBench::threads_of(const SceneVolume& volume, const RaycastScene& scene, SkipKind skip) {
  const auto one = rig(scene, {volume, skip, native_, 1});
  const auto two = rig(scene, {volume, skip, native_, 2});
  const std::vector<CastArea> tiles = split_tiles(scene.eye.width_px, scene.eye.height_px, native_tile_px);
  for (std::size_t t = 0; t < scene.transfers.size(); ++t) {
    ScalingThreadsRow row;
    row.width_px = scene.eye.width_px;
    row.height_px = scene.eye.height_px;
    row.transfer = scene.transfers[t].name;
    row.skips = skip != SkipKind::none;
    row.tiles = tiles.size();
    const auto times = shortest(options_.repetitions, {{*one, t}, {*two, t}});
    row.ms_1 = times[0].ms;
    row.ms_2 = times[1].ms;
    simulate(*one, t, tiles, row);
    result_.threads.push_back(row);
  }
}

void ScalingBench::simulate(RaycastRig& rig, std::size_t transfer, const std::vector<CastArea>& tiles,
                            ScalingThreadsRow& row) const {
  std::vector<double> counted(tiles.size(), 0.0);
  std::vector<double> timed_ms(tiles.size(), std::numeric_limits<double>::infinity());
  for (int i = 0; i < options_.repetitions; ++i) {
    for (std::size_t k = 0; k < tiles.size(); ++k) {
      const RaycastRig::Part part = rig.cast_part(transfer, tiles[k]);
      counted[k] = counted_cost(part.counted);
      timed_ms[k] = std::min(timed_ms[k], part.ms);
    }
  }
  for (const int threads : ScalingBenchResult::thread_counts) {
    row.speed_ups_counted.push_back(speed_up(counted, threads));
    row.speed_ups_timed.push_back(speed_up(timed_ms, threads));
  }
  const double all = makespan(counted, 1);
  row.longest_tile_ratio = all > 0.0 ? *std::max_element(counted.begin(), counted.end()) / all : 0.0;
}

void ScalingBench::image() {
  const SceneVolume volume(device_, ball(), path_of(ball()));
  for (const int edge_px : options_.image_edges_px) {
    const RaycastScene scene = scene_for(options_.edge_voxels, edge_px, edge_px);
    for (const StageInfo* native : casters()) {
      for (const SkipKind skip : {SkipKind::none, SkipKind::distance_map}) {
        const auto caster = rig(scene, {volume, skip, native});
        std::vector<ScalingImageRow> rows;
        for (std::size_t t = 0; t < scene.transfers.size(); ++t) {
          const WorkCounts counts = caster->count(t);
          rows.push_back({edge_px, name_of_renderer(native, volume), scene.transfers[t].name,
                          skip != SkipKind::none, counts.rays, counts.samples, counts.skip_steps});
        }
        time_rows(options_.repetitions, *caster, rows);
        result_.image.insert(result_.image.end(), rows.begin(), rows.end());
      }
    }
    say(fmt::format("image: {0} x {0} done", edge_px));
  }
}

void ScalingBench::volume() {
  for (const auto& dims : options_.volumes) {
    const SceneBall ball{.dims = dims};
    try {
      const VolumePathChoice path = path_of(ball);
      volume_of(SceneVolume(device_, ball, path), true);
      if (path.path == VolumePath::packed)
        volume_of(SceneVolume(device_, ball, path_of(ball, VolumePath::sampler)), false);
    } catch (const gpu::DeviceLost&) {
      throw;
    } catch (const Error& error) {
      result_.notes.push_back(fmt::format("{} was not measured: {}", text_of(dims), error.what()));
    }
    say(fmt::format("volume: {} done", text_of(dims)));
  }
}

/// cast/native keeps voxels of its own: once is enough.
void ScalingBench::volume_of(const SceneVolume& volume, bool is_chosen) {
  for (const StageInfo* native : casters()) {
    if (native != nullptr && !is_chosen) continue;
    casts_of(volume, native, is_chosen, false);
    casts_of(volume, native, is_chosen, true);
  }
}

void ScalingBench::casts_of(const SceneVolume& volume, const StageInfo* native, bool is_chosen,
                            bool same_distance) {
  const int edge = longest(volume.ball.dims);
  const int size_px = same_distance ? options_.size_px * edge / options_.edge_voxels : options_.size_px;
  const RaycastScene scene = scene_for(edge, size_px, size_px);
  const auto caster = rig(scene, {volume, SkipKind::none, native});
  std::vector<ScalingVolumeRow> rows;
  for (std::size_t t = 0; t < scene.transfers.size(); ++t) {
    ScalingVolumeRow row;
    row.dims = volume.ball.dims;
    row.renderer = name_of_renderer(native, volume);
    row.transfer = scene.transfers[t].name;
    row.is_chosen = is_chosen;
    row.same_distance = same_distance;
    row.size_px = size_px;
    row.ray_distance_voxels = ray_distance_voxels(scene, edge);
    row.samples = caster->count(t).samples;
    rows.push_back(row);
  }
  time_rows(options_.repetitions, *caster, rows);
  result_.volume.insert(result_.volume.end(), rows.begin(), rows.end());
}

/// Voxels up to this value are nearest to the share that is asked for; -1: none of them.
int threshold_for(const SceneVolume& volume, double share) {
  int best = -1;
  for (int value = 0; value < 254; ++value) {
    const double before = best < 0 ? 0.0 : volume.share_up_to(best);
    if (std::abs(volume.share_up_to(value) - share) < std::abs(before - share)) best = value;
  }
  return best;
}

/// A ball that is larger than its box and faint, so that values are spread over the whole scale.
void ScalingBench::empty() {
  SceneBall wide = ball();
  wide.radius = 1.75;
  wide.slope = 0.42;
  const SceneVolume volume(device_, wide, path_of(wide));
  for (const double share : options_.empty_shares) {
    const int threshold = threshold_for(volume, share);
    const double empty_ratio = threshold < 0 ? 0.0 : volume.share_up_to(threshold);
    RaycastScene scene = make_raycast_scene(options_.size_px, options_.size_px);
    for (RaycastScene::Transfer& transfer : scene.transfers)
      transfer.function = scene_transfer(transfer.name, threshold);
    for (const StageInfo* native : casters()) {
      const auto none = rig(scene, {volume, SkipKind::none, native});
      const auto distance = rig(scene, {volume, SkipKind::distance_map, native});
      for (std::size_t t = 0; t < scene.transfers.size(); ++t) {
        const auto times = shortest(options_.repetitions, {{*none, t}, {*distance, t}});
        result_.empty.push_back({name_of_renderer(native, volume), scene.transfers[t].name, empty_ratio,
                                 times[0].ms, times[1].ms});
      }
    }
    say(fmt::format("empty: {:.1f} % done", 100.0 * empty_ratio));
  }
}

void check_parts(const std::vector<std::string>& parts) {
  const std::vector<std::string> known = {"threads", "image", "volume", "empty"};
  for (const std::string& part : parts) {
    if (std::find(known.begin(), known.end(), part) != known.end()) continue;
    throw input_error("bench scaling: there is no part '{}'{}; accepted: {}", part, did_you_mean(part, known),
                      join(known));
  }
}

}  // namespace

ScalingBenchResult bench_scaling(const ScalingBenchOptions& options) {
  check_parts(options.parts);
  ScalingBenchResult result;
  result.host_cores = std::thread::hardware_concurrency();
  result.host_load = host_load();
  result.repetitions = options.repetitions;
  result.size_px = options.size_px;
  result.edge_voxels = options.edge_voxels;
  ScalingBench bench(options, result);
  const auto asked = [&](const char* part) {
    return std::find(options.parts.begin(), options.parts.end(), part) != options.parts.end();
  };
  if (asked("threads")) bench.threads();
  if (asked("image")) bench.image();
  if (asked("volume")) bench.volume();
  if (asked("empty")) bench.empty();
  return result;
}

}  // namespace brace
