#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/raycast.hpp"

namespace brace {

namespace {

constexpr double target_ratio = 2.0;  // cast/dvr without skipping over VTK's GPU mapper

/// With skipping over VTK's fixed-point mapper on two threads.
struct SkippingTarget {
  const char* renderer;  // how its name begins
  const char* transfer;
  double ratio;
};
constexpr SkippingTarget skipping_targets[] = {
    {"cast/dvr", "T", 1.9}, {"cast/dvr", "S", 4.0}, {"cast/native", "T", 7.0}, {"cast/native", "S", 20.0}};

/// The rival's figure over that of our first case with the same transfer function; 0 when one is missing.
double ratio_of(const RaycastBenchResult& result, const RaycastBenchCase& rival,
                double RaycastBenchCase::*figure) {
  for (const RaycastBenchCase& one : result.cases) {
    if (one.is_rival || one.transfer != rival.transfer) continue;
    return one.*figure > 0.0 ? rival.*figure / one.*figure : 0.0;
  }
  return 0.0;
}

bool is_gpu_mapper(const RaycastBenchCase& one) {
  return one.renderer.starts_with("VTK GPU");
}

/// The shortest frame of the renderer whose name begins so; 0 when it is missing.
double shortest_ms(const RaycastBenchResult& result, const std::string& begin, const std::string& transfer,
                   bool skips) {
  for (const RaycastBenchCase& one : result.cases) {
    if (one.transfer == transfer && one.skips == skips && one.renderer.starts_with(begin))
      return one.frame_ms_min;
  }
  return 0.0;
}

std::string skipping_text(const RaycastBenchResult& result) {
  std::string text;
  for (const SkippingTarget& target : skipping_targets) {
    const double ours = shortest_ms(result, target.renderer, target.transfer, true);
    const double rival = shortest_ms(result, "VTK fixed-point mapper, 2", target.transfer, false);
    if (ours <= 0.0 || rival <= 0.0) continue;
    text += fmt::format(
        "Target {}, {} with skipping: at least {:.1f} x as fast as VTK's fixed-point mapper on 2 threads: "
        "{:.2f} x, {}\n",
        target.transfer, target.renderer, target.ratio, rival / ours,
        rival / ours >= target.ratio ? "met" : "not met in this run");
  }
  return text;
}

}  // namespace

double raycast_ratio(const RaycastBenchResult& result, const RaycastBenchCase& rival) {
  return ratio_of(result, rival, &RaycastBenchCase::frame_ms_min);
}

double raycast_cpu_ratio(const RaycastBenchResult& result, const RaycastBenchCase& rival) {
  return ratio_of(result, rival, &RaycastBenchCase::cpu_ms_min);
}

std::string to_text(const RaycastBenchResult& result) {
  std::string text = fmt::format(
      "Ray casting: 256^3 uint8, {:.0f} % of the voxels zero, {} x {} pixels, half a voxel "
      "per step\n"
      "on {}, {} host cores at a load of {:.1f}, {} repetitions\n"
      "data path {}\n\n"
      "{:<54} {:>2} {:>9} {:>9} {:>9} {:>9} {:>7} {:>7}\n",
      100.0 * result.zero_voxels_ratio, result.size_px, result.size_px, result.device, result.host_cores,
      result.host_load, result.repetitions, result.path_reason, "", "TF", "median ms", "min ms", "CPU ms",
      "Msample/s", "x time", "x CPU");
  for (const RaycastBenchCase& one : result.cases) {
    const std::string speed = one.samples > 0 ? fmt::format("{:.1f}", 1e-6 * one.samples_per_s) : "-";
    const std::string cpu = one.cpu_ms_min > 0.0 ? fmt::format("{:.0f}", one.cpu_ms_min) : "-";
    text += fmt::format("{:<54} {:>2} {:>9.1f} {:>9.1f} {:>9} {:>9} {:>7.2f} {:>7.2f}\n", one.renderer,
                        one.transfer, one.frame_ms_median, one.frame_ms_min, cpu, speed,
                        raycast_ratio(result, one), raycast_cpu_ratio(result, one));
  }
  text +=
      "\nx time: the shortest frame over that of our first row; x CPU: the same for the CPU time of all "
      "threads,\n"
      "which a busy machine changes less.\n";
  for (const RaycastBenchCase& one : result.cases) {
    if (!is_gpu_mapper(one)) continue;
    const double ratio = raycast_ratio(result, one);
    text += fmt::format(
        "Target {}: at least {:.0f} x as fast as VTK's GPU mapper: {:.2f} x ({:.2f} x by CPU time), {}\n",
        one.transfer, target_ratio, ratio, raycast_cpu_ratio(result, one),
        ratio >= target_ratio ? "met" : "not met in this run");
  }
  text += skipping_text(result);
  for (const std::string& note : result.notes)
    text += note + "\n";
  text.pop_back();
  return text;
}

std::string to_json(const RaycastBenchResult& result) {
  using nlohmann::ordered_json;
  ordered_json cases = ordered_json::array();
  for (const RaycastBenchCase& one : result.cases) {
    ordered_json entry = {{"renderer", one.renderer},
                          {"transfer", one.transfer},
                          {"rival", one.is_rival},
                          {"frame_ms_median", one.frame_ms_median},
                          {"frame_ms_min", one.frame_ms_min},
                          {"ratio", raycast_ratio(result, one)},
                          {"cpu_ratio", raycast_cpu_ratio(result, one)}};
    if (one.cpu_ms_min > 0.0) entry["cpu_ms_min"] = one.cpu_ms_min;
    if (one.samples > 0) {
      entry["samples"] = one.samples;
      entry["samples_per_s"] = one.samples_per_s;
    }
    cases.push_back(std::move(entry));
  }
  const ordered_json json = {{"bench", "raycast"},
                             {"device", result.device},
                             {"data_path", result.path_reason},
                             {"host_cores", result.host_cores},
                             {"host_load", result.host_load},
                             {"repetitions", result.repetitions},
                             {"size_px", result.size_px},
                             {"zero_voxels_ratio", result.zero_voxels_ratio},
                             {"cases", std::move(cases)},
                             {"target_ratio_gpu_mapper", target_ratio},
                             {"notes", result.notes}};
  return json.dump(2);
}

}  // namespace brace
