#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/scaling.hpp"

namespace brace {

namespace {

using nlohmann::ordered_json;

const char* yes_no(bool value) {
  return value ? "yes" : "no";
}

std::string dims_text(const std::array<int, 3>& dims) {
  return fmt::format("{}x{}x{}", dims[0], dims[1], dims[2]);
}

double ns_per_sample(double ms, std::uint64_t samples) {
  return samples > 0 ? 1e6 * ms / static_cast<double>(samples) : 0.0;
}

double per_ray_ns(const ScalingImageRow& row) {
  return row.rays > 0 ? 1e6 * row.ms / static_cast<double>(row.rays) : 0.0;
}

std::string threads_text(const ScalingBenchResult& result) {
  if (result.threads.empty()) return "";
  std::string text =
      "cast/native on threads: measured with 1 and 2; simulated from tiles by counted work (their times on "
      "one thread)\n";
  text += fmt::format("{:<11} {:>2} {:>4} {:>5} {:>8} {:>8} {:>5} ", "picture", "TF", "map", "tiles", "ms, 1",
                      "ms, 2", "x");
  for (const int threads : ScalingBenchResult::thread_counts)
    text += fmt::format(" {:>13}", fmt::format("x on {}", threads));
  text += fmt::format(" {:>8}\n", "longest");
  for (const ScalingThreadsRow& row : result.threads) {
    text += fmt::format("{:<11} {:>2} {:>4} {:>5} {:>8.1f} {:>8.1f} {:>5.2f} ",
                        fmt::format("{} x {}", row.width_px, row.height_px), row.transfer, yes_no(row.skips),
                        row.tiles, row.ms_1, row.ms_2, row.ms_1 / row.ms_2);
    for (std::size_t i = 0; i < row.speed_ups_counted.size(); ++i)
      text += fmt::format(" {:>13}",
                          fmt::format("{:.2f} ({:.2f})", row.speed_ups_counted[i], row.speed_ups_timed[i]));
    text += fmt::format(" {:>6.2f} %\n", 100.0 * row.longest_tile_ratio);
  }
  return text +
         "map: with a distance map; longest: share of the work in the longest tile. Simulated: threads do "
         "not "
         "slow each\nother down, and each takes the next tile as soon as it is free.\n\n";
}

std::string image_text(const ScalingBenchResult& result) {
  if (result.image.empty()) return "";
  std::string text = fmt::format(
      "Picture, volume {0}^3\n{1:<20} {2:>6} {3:>2} {4:>4} {5:>9} {6:>10} {7:>9} {8:>10} {9:>14} {10:>9}\n",
      result.edge_voxels, "", "edge", "TF", "map", "ms", "samples", "look-ups", "ns/sample", "CPU ns/sample",
      "ns/ray");
  for (const ScalingImageRow& row : result.image)
    text += fmt::format(
        "{:<20} {:>6} {:>2} {:>4} {:>9.2f} {:>8.2f} M {:>7.2f} M {:>10.2f} {:>14.2f} {:>9.0f}\n",
        row.renderer, row.edge_px, row.transfer, yes_no(row.skips), row.ms,
        1e-6 * static_cast<double>(row.samples), 1e-6 * static_cast<double>(row.skip_steps),
        ns_per_sample(row.ms, row.samples), ns_per_sample(row.cpu_ms, row.samples), per_ray_ns(row));
  return text + "\n";
}

/// A series of the volume table: which rows, and what it is called.
struct Series {
  const char* name;
  const char* renderer;  // how it begins
  bool only_chosen;
};
constexpr Series all_series[] = {{"cast/native", "cast/native", true},
                                 {"cast/dvr on the path taken", "cast/dvr", true},
                                 {"cast/dvr, sampler", "cast/dvr, sampler", false}};

/// Costs per sample over those of the first volume, where they are farthest from it; 0: not measured.
struct Verdict {
  const char* series;
  const char* transfer;
  bool same_distance;
  double ratio = 0, cpu_ratio = 0;

  /// By CPU time where the work is done on the CPU.
  bool is_met() const {
    return std::abs((cpu_ratio > 0.0 ? cpu_ratio : ratio) - 1.0) <= ScalingBenchResult::volume_tolerance;
  }
};

void take_worse(double& worst, double value, double base) {
  if (base <= 0.0) return;
  const double ratio = value / base;
  if (worst == 0.0 || std::abs(ratio - 1.0) > std::abs(worst - 1.0)) worst = ratio;
}

Verdict judge(const ScalingBenchResult& result, const Series& series, const char* transfer,
              bool same_distance) {
  Verdict verdict{series.name, transfer, same_distance};
  const ScalingVolumeRow* base = nullptr;
  for (const ScalingVolumeRow& row : result.volume) {
    if (!row.renderer.starts_with(series.renderer) || row.transfer != transfer) continue;
    if (series.only_chosen && !row.is_chosen) continue;
    if (row.same_distance != same_distance) continue;
    if (base == nullptr) {
      base = &row;
    } else {
      take_worse(verdict.ratio, ns_per_sample(row.ms, row.samples), ns_per_sample(base->ms, base->samples));
      take_worse(verdict.cpu_ratio, ns_per_sample(row.cpu_ms, row.samples),
                 ns_per_sample(base->cpu_ms, base->samples));
    }
  }
  return verdict;
}

std::vector<Verdict> judge_all(const ScalingBenchResult& result) {
  std::vector<Verdict> verdicts;
  for (const Series& series : all_series)
    for (const bool same_distance : {false, true})
      for (const char* transfer : {"T", "S"}) {
        const Verdict verdict = judge(result, series, transfer, same_distance);
        if (verdict.ratio > 0.0) verdicts.push_back(verdict);
      }
  return verdicts;
}

std::string volume_text(const ScalingBenchResult& result) {
  if (result.volume.empty()) return "";
  std::string text =
      fmt::format("Volume\n{0:<20} {1:>14} {2:>2} {3:>8} {4:>13} {5:>9} {6:>10} {7:>10} {8:>14}\n", "",
                  "voxels", "TF", "picture", "ray distance", "ms", "samples", "ns/sample", "CPU ns/sample");
  for (const ScalingVolumeRow& row : result.volume)
    text +=
        fmt::format("{:<20} {:>14} {:>2} {:>6}^2 {:>7.2f} voxel {:>9.1f} {:>8.1f} M {:>10.2f} {:>14.2f}{}\n",
                    row.renderer, dims_text(row.dims), row.transfer, row.size_px, row.ray_distance_voxels,
                    row.ms, 1e-6 * static_cast<double>(row.samples), ns_per_sample(row.ms, row.samples),
                    ns_per_sample(row.cpu_ms, row.samples), row.is_chosen ? "" : "  (not the path taken)");
  text += fmt::format(
      "Target: CPU time per sample (elsewhere: time) within {:.0f} % of that of the first volume, at "
      "worst:\n",
      100.0 * ScalingBenchResult::volume_tolerance);
  for (const Verdict& verdict : judge_all(result))
    text += fmt::format("  {}, {}, {}: {:.2f} x by CPU time, {:.2f} x by time, {}\n", verdict.series,
                        verdict.transfer,
                        verdict.same_distance ? "picture as large as the volume" : "the same picture",
                        verdict.cpu_ratio, verdict.ratio, verdict.is_met() ? "met" : "not met in this run");
  return text + "\n";
}

std::string empty_text(const ScalingBenchResult& result) {
  if (result.empty.empty()) return "";
  std::string text = fmt::format(
      "Empty voxels, volume {0}^3, {1} x {1} pixels\n{2:<20} {3:>2} {4:>9} {5:>11} {6:>15} {7:>7}\n",
      result.edge_voxels, result.size_px, "", "TF", "invisible", "without ms", "distance map ms", "ratio");
  for (const ScalingEmptyRow& row : result.empty)
    text += fmt::format("{:<20} {:>2} {:>7.1f} % {:>11.2f} {:>15.2f} {:>7.2f}\n", row.renderer, row.transfer,
                        100.0 * row.empty_ratio, row.none_ms, row.distance_ms, row.distance_ms / row.none_ms);
  return text + "ratio: with a distance map over without; below 1 the map pays.\n\n";
}

ordered_json threads_json(const ScalingBenchResult& result) {
  ordered_json rows = ordered_json::array();
  for (const ScalingThreadsRow& row : result.threads)
    rows.push_back({{"width_px", row.width_px},
                    {"height_px", row.height_px},
                    {"transfer", row.transfer},
                    {"skips", row.skips},
                    {"tiles", row.tiles},
                    {"ms_1_thread", row.ms_1},
                    {"ms_2_threads", row.ms_2},
                    {"longest_tile_ratio", row.longest_tile_ratio},
                    {"speed_ups_counted", row.speed_ups_counted},
                    {"speed_ups_timed", row.speed_ups_timed}});
  return rows;
}

ordered_json image_json(const ScalingBenchResult& result) {
  ordered_json rows = ordered_json::array();
  for (const ScalingImageRow& row : result.image)
    rows.push_back({{"edge_px", row.edge_px},
                    {"renderer", row.renderer},
                    {"transfer", row.transfer},
                    {"skips", row.skips},
                    {"rays", row.rays},
                    {"samples", row.samples},
                    {"skip_steps", row.skip_steps},
                    {"ms", row.ms},
                    {"cpu_ms", row.cpu_ms},
                    {"ns_per_sample", ns_per_sample(row.ms, row.samples)},
                    {"cpu_ns_per_sample", ns_per_sample(row.cpu_ms, row.samples)},
                    {"ns_per_ray", per_ray_ns(row)}});
  return rows;
}

ordered_json volume_json(const ScalingBenchResult& result) {
  ordered_json rows = ordered_json::array();
  for (const ScalingVolumeRow& row : result.volume)
    rows.push_back({{"dims", row.dims},
                    {"renderer", row.renderer},
                    {"transfer", row.transfer},
                    {"is_chosen_path", row.is_chosen},
                    {"same_distance", row.same_distance},
                    {"size_px", row.size_px},
                    {"ray_distance_voxels", row.ray_distance_voxels},
                    {"samples", row.samples},
                    {"ms", row.ms},
                    {"cpu_ms", row.cpu_ms},
                    {"ns_per_sample", ns_per_sample(row.ms, row.samples)},
                    {"cpu_ns_per_sample", ns_per_sample(row.cpu_ms, row.samples)}});
  return rows;
}

ordered_json verdicts_json(const ScalingBenchResult& result) {
  ordered_json rows = ordered_json::array();
  for (const Verdict& verdict : judge_all(result))
    rows.push_back({{"renderer", verdict.series},
                    {"transfer", verdict.transfer},
                    {"same_distance", verdict.same_distance},
                    {"worst_ratio", verdict.ratio},
                    {"worst_cpu_ratio", verdict.cpu_ratio},
                    {"met", verdict.is_met()}});
  return rows;
}

ordered_json empty_json(const ScalingBenchResult& result) {
  ordered_json rows = ordered_json::array();
  for (const ScalingEmptyRow& row : result.empty)
    rows.push_back({{"renderer", row.renderer},
                    {"transfer", row.transfer},
                    {"empty_ratio", row.empty_ratio},
                    {"none_ms", row.none_ms},
                    {"distance_ms", row.distance_ms},
                    {"ratio", row.distance_ms / row.none_ms}});
  return rows;
}

}  // namespace

std::string to_text(const ScalingBenchResult& result) {
  std::string text = fmt::format(
      "Scaling of ray casting on {}, {} host cores at a load of {:.1f}, the shortest of {} casts\n\n",
      result.device, result.host_cores, result.host_load, result.repetitions);
  text += threads_text(result) + image_text(result) + volume_text(result) + empty_text(result);
  for (const std::string& note : result.notes)
    text += note + "\n";
  while (text.ends_with('\n'))
    text.pop_back();
  return text;
}

std::string to_json(const ScalingBenchResult& result) {
  const ordered_json json = {{"bench", "scaling"},
                             {"device", result.device},
                             {"host_cores", result.host_cores},
                             {"host_load", result.host_load},
                             {"repetitions", result.repetitions},
                             {"size_px", result.size_px},
                             {"edge_voxels", result.edge_voxels},
                             {"thread_counts", ScalingBenchResult::thread_counts},
                             {"threads", threads_json(result)},
                             {"image", image_json(result)},
                             {"volume", volume_json(result)},
                             {"volume_tolerance", ScalingBenchResult::volume_tolerance},
                             {"volume_verdicts", verdicts_json(result)},
                             {"empty", empty_json(result)},
                             {"notes", result.notes}};
  return json.dump(2);
}

}  // namespace brace
