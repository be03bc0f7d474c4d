#include "bench/skip.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "bench/skip_frames.hpp"
#include "bench/skip_octants.hpp"
#include "bench/skip_published.hpp"
#include "bench/skip_scenes.hpp"
#include "bench/skip_threshold.hpp"
#include "runtime/skip/structures.hpp"

namespace brace {

namespace {

using bench::PublishedMaps;

double least_ms(int repetitions, const std::function<double()>& measure) {
  double least = measure();  // also warms up
  for (int i = 0; i < repetitions; ++i)
    least = std::min(least, measure());
  return least;
}

/// Device time of what `record` records, ms.
double device_ms(const gpu::Device& device, const std::function<void(gpu::CommandList&)>& record) {
  gpu::CommandList commands(device, "measured");
  commands.begin_timing("all");
  record(commands);
  commands.barrier();
  commands.end_timing();
  return static_cast<double>(gpu::submit_and_wait(commands)[0].device_ns) * 1e-6;
}

double wall_ms(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double copy_gb_per_s(const gpu::Device& device) {
  constexpr std::uint64_t bytes = std::uint64_t{64} << 20;
  const gpu::Buffer from(device, "copy from", bytes, gpu::Memory::device);
  const gpu::Buffer to(device, "copy to", bytes, gpu::Memory::device);
  const double ms = least_ms(5, [&] {
    return device_ms(device, [&](gpu::CommandList& commands) { commands.copy(from, to, bytes); });
  });
  return 2.0 * static_cast<double>(bytes) / ms * 1e-6;
}

double load_average() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0.0;
}

/// One generated volume through all cells of Table 1.
class SceneBench {
 public:
  SceneBench(const gpu::Device& device, SkipKernels& kernels, const bench::SkipScene& scene,
             const SkipBenchOptions& options, SkipBenchResult& result)
      : device_(device),
        kernels_(kernels),
        scene_(scene),
        options_(options),
        result_(result),
        scan_(VoxelType::uint8) {
    const auto source = bench::open_skip_scene(scene);
    volume_ = VolumeOnDevice(device, *source, VolumePath::sampler, &scan_);
    statistics_ = scan_.result();
    published_ =
        std::make_unique<PublishedMaps>(device, volume_, options.data_folder / "bench/skip_published");
    say("volume made");
  }

  void updates() {
    for (int tf = 1; tf <= 6; ++tf)
      result_.updates.push_back(from_volume(tf));
    for (const int n : options_.partitions)
      merges(n);
  }

  void frames() {
    const auto rows = bench::measure_frames(device_, kernels_, scene_.name, volume_, statistics_,
                                            bench::paper_tables(), bench::all_variants(), options_);
    result_.frames.insert(result_.frames.end(), rows.begin(), rows.end());
  }

 private:
  void say(const std::string& what) const {
    if (options_.progress) options_.progress(fmt::format("{}: {}", scene_.name, what));
  }

  SkipScene scene() const { return {volume_, statistics_}; }

  std::unique_ptr<SkipStructure> make(SkipKind kind, int partitions, RangeMinima minima = RangeMinima::none) {
    SkipOptions options;
    options.kind = kind;
    options.partitions = partitions;
    options.range_minima = minima;
    if (skip_memory(volume_.info(), options).kept_bytes > options_.memory_bytes_max) return nullptr;
    return make_skip_structure(kernels_, scene(), options);
  }

  double update_ms(SkipStructure& structure, const TransferTable& table, int repetitions) {
    return least_ms(repetitions, [&] {
      return device_ms(device_, [&](gpu::CommandList& commands) { structure.update(commands, table); });
    });
  }

  SkipUpdateRow from_volume(int tf) {
    const TransferTable table = bench::skip_table(tf);
    SkipUpdateRow row;
    row.scene = scene_.name;
    row.tf = tf;
    row.published_ms = least_ms(tf == 1 ? 1 : 0, [&] { return published_->recompute_ms(table); });
    if (!block_) {
      block_ = make(SkipKind::block, 1);
      distance_ = make(SkipKind::distance_map, 1);
      bitmask_ = make(SkipKind::bitmask, 64);
    }
    row.recomputed_ms = update_ms(*distance_, table, 1);
    row.block_ms = update_ms(*block_, table, options_.repetitions);
    row.bitmask_ms = bitmask_ ? update_ms(*bitmask_, table, options_.repetitions) : -1;
    say(fmt::format("TF{} from the volume done", tf));
    return row;
  }

  void merges(int n) {
    std::unique_ptr<SkipStructure> maps, tree;
    SkipInitRow init{scene_.name, n};
    init.all_ms = wall_ms([&] { maps = make(SkipKind::partitioned, n); });
    if (!maps) {
      say(fmt::format("{} partitions left out: they need more than {} MB", n,
                      options_.memory_bytes_max / 1'000'000));
      return;
    }
    init.memory_mb = static_cast<double>(maps->device_bytes()) * 1e-6;
    SkipOptions bitmask;
    bitmask.kind = SkipKind::bitmask;
    bitmask.partitions = n;
    init.bitmask_mb = static_cast<double>(skip_memory(volume_.info(), bitmask).kept_bytes) * 1e-6;
    // A partition by itself: a transfer function that shows just its values.
    TransferTable one = bench::skip_table(2);
    for (std::size_t i = 0; i < one.entries.size(); ++i)
      if (i / static_cast<std::size_t>(256 / n) != 1) one.entries[i][3] = 0.0;
    init.single_ms = published_->recompute_ms(one);
    result_.inits.push_back(init);
    tree = make(SkipKind::partitioned, n, RangeMinima::segment_tree);
    const std::uint64_t paper_bytes = static_cast<std::uint64_t>(n) * maps->grid().count();
    const bool paper = paper_bytes <= options_.memory_bytes_max / 2;
    if (paper) published_->make_maps(n);
    const Partitioning partitioning = uniform_partitions(VoxelType::uint8, statistics_.range, n);
    for (int tf = 1; tf <= 6; ++tf) {
      const TransferTable table = bench::skip_table(tf);
      const auto visible =
          Visibility(table, interpolation_slack(volume_, statistics_.range)).partitions(partitioning);
      SkipUpdateRow::Merge merge{n, static_cast<int>(std::count(visible.begin(), visible.end(), true))};
      merge.merge_ms = update_ms(*maps, table, options_.repetitions);
      merge.tree_ms = tree ? update_ms(*tree, table, options_.repetitions) : -1;
      merge.paper_ms = paper ? least_ms(1, [&] { return published_->merge_ms(merge.maps); }) : -1;
      merge.gb_per_s =
          (merge.maps + 1.0) * static_cast<double>(maps->grid().map_bytes()) / merge.merge_ms * 1e-6;
      for (SkipUpdateRow& row : result_.updates)
        if (row.scene == scene_.name && row.tf == tf) row.merges.push_back(merge);
    }
    published_->make_maps(0);
    say(fmt::format("{} partitions done", n));
  }

  const gpu::Device& device_;
  SkipKernels& kernels_;
  bench::SkipScene scene_;
  const SkipBenchOptions& options_;
  SkipBenchResult& result_;
  VoxelScan scan_;
  VolumeOnDevice volume_;
  VoxelStatistics statistics_;
  std::unique_ptr<PublishedMaps> published_;
  std::unique_ptr<SkipStructure> block_, distance_, bitmask_;
};

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_names(const char* what, const std::vector<std::string>& given,
                 const std::vector<std::string>& known) {
  for (const std::string& name : given) {
    if (has(known, name)) continue;
    throw input_error("bench skip: there is no {} '{}'{}; accepted: {}", what, name,
                      did_you_mean(name, known), join(known));
  }
}

std::vector<std::string> published_lines(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream)
    throw input_error("{}: cannot be read (accepted: the data folder of an installation)", file.string());
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty() && line.front() != '#') lines.push_back(line);
  return lines;
}

}  // namespace

SkipBenchResult bench_skip(const SkipBenchOptions& options) {
  check_names("scene", options.scenes, {"head", "insect", "snake", "none"});
  check_names("part", options.parts, {"updates", "frames", "threshold", "octants"});
  const gpu::Device device(options.device);
  SkipKernels kernels(device, options.data_folder / "kernels/skip");
  SkipBenchResult result;
  result.device = device.info().name;
  result.host_load = load_average();
  result.published = published_lines(options.data_folder / "bench/pdm_table1.csv");
  result.copy_gb_per_s = copy_gb_per_s(device);
  for (const bench::SkipScene& scene : bench::skip_scenes(options.divisor)) {
    if (!has(options.scenes, scene.name) || !(has(options.parts, "updates") || has(options.parts, "frames")))
      continue;
    SceneBench scene_bench(device, kernels, scene, options, result);
    if (has(options.parts, "updates")) scene_bench.updates();
    if (has(options.parts, "frames")) scene_bench.frames();
  }
  for (const std::string& name : options.volumes) {
    const auto source = open_volume(name);
    VoxelScan scan(source->info().type);
    const VolumeOnDevice volume(device, *source, VolumePath::automatic, &scan);
    const VoxelStatistics statistics = scan.result();
    const auto rows =
        bench::measure_frames(device, kernels, std::filesystem::path(name).filename().string(), volume,
                              statistics, bench::tables_for(statistics), bench::all_variants(), options);
    result.frames.insert(result.frames.end(), rows.begin(), rows.end());
  }
  if (has(options.parts, "threshold"))
    result.thresholds = bench::measure_thresholds(device, kernels, options);
  if (has(options.parts, "octants")) result.octants = bench::count_octants(options);
  return result;
}

}  // namespace brace
