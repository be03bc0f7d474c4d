#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/mab.hpp"

namespace brace {

namespace {

std::string atlas_text(const std::vector<MabAtlasRow>& rows) {
  std::string text = "\natlas of 90, 70, 50, 30 %: texels used over the rectangle's\n";
  text += fmt::format("{:<16}{:>10}{:>10}{:>12}\n", "profile", "used", "packed", "one column");
  for (const MabAtlasRow& row : rows)
    text += fmt::format("{:<16}{:>10}{:>8.1f} %{:>10.1f} %\n", row.profile, row.used,
                        100.0 * static_cast<double>(row.used) / static_cast<double>(row.packed),
                        100.0 * static_cast<double>(row.used) / static_cast<double>(row.fixed));
  return text;
}

std::string error_text(const MabBenchResult& result) {
  std::string text = "\nerror against a ray per pixel, behind the lens\n";
  text += fmt::format("{:<14}{:<32}{:<20}{:>8}{:>10}{:>16}\n", "profile", "volume", "map", "rays", "DSSIM",
                      "weighted RMSE");
  for (const MabErrorRow& row : result.errors)
    text += fmt::format("{:<14}{:<32}{:<20}{:>6.1f} %{:>10.5f}{:>16.5f}\n", row.profile, row.volume, row.map,
                        100.0 * row.ray_share, row.dssim, row.weighted_rmse);
  text +=
      "\nat equal rays over map = radius: DSSIM of lens (target: at most 1), weighted RMSE of "
      "lens_eccentricity\n";
  text += fmt::format("{:<14}{:<32}{:>8}{:>8}{:>14}{:>8}\n", "profile", "volume", "mean", "worst", "weighted",
                      "worst");
  for (const MabMapRow& row : result.maps)
    text += fmt::format("{:<14}{:<32}{:>8.3f}{:>8.3f}{:>14.3f}{:>8.3f}\n", row.profile, row.volume,
                        row.ratio_mean, row.ratio_worst, row.weighted_mean, row.weighted_worst);
  return text;
}

std::string time_text(const std::vector<MabTimeRow>& rows) {
  std::string text =
      "\ndevice time over that of a ray per pixel (target for compact: within 15 % of the rays)\n";
  text += fmt::format("{:<20}{:<10}{:>8}{:>8}{:>14}\n", "map", "scheme", "rays", "time", "time / rays");
  for (const MabTimeRow& row : rows)
    text += fmt::format("{:<20}{:<10}{:>6.1f} %{:>6.1f} %{:>14.3f}\n", row.map, row.scheme,
                        100.0 * row.ray_share, 100.0 * row.time_share, row.time_share / row.ray_share);
  return text;
}

std::string control_text(const std::vector<MabControlRow>& rows) {
  std::string text =
      "\n3,000 vsyncs under a load that changes (target for the step: 0.6 % missed, longest run 3)\n";
  text += fmt::format("{:<19}{:<13}{:<14}{:>9}{:>13}{:>22}{:>13}{:>13}\n", "load", "schedule", "control",
                      "missed", "longest run", "eye frame repeated", "longest run", "rays, mean");
  for (const MabControlRow& row : rows)
    text += fmt::format("{:<19}{:<13}{:<14}{:>7.2f} %{:>13}{:>20.2f} %{:>13}{:>11.1f} %\n", row.load,
                        row.schedule, row.control, row.missed_percent, row.longest_run, row.repeated_percent,
                        row.longest_repeats, 100.0 * row.ray_share_mean);
  return text;
}

}  // namespace

std::string to_text(const MabBenchResult& result) {
  std::string text = fmt::format("rays/mab on {}; {} repetitions, load {:.2f}\n", result.device,
                                 result.repetitions, result.host_load);
  if (!result.atlases.empty()) text += atlas_text(result.atlases);
  if (!result.errors.empty()) text += error_text(result);
  if (!result.times.empty()) text += time_text(result.times);
  if (!result.controls.empty()) text += control_text(result.controls);
  return text;
}

std::string to_json(const MabBenchResult& result) {
  using nlohmann::ordered_json;
  ordered_json json{
      {"device", result.device}, {"repetitions", result.repetitions}, {"host_load", result.host_load}};
  for (const MabAtlasRow& row : result.atlases)
    json["atlases"].push_back(ordered_json{
        {"profile", row.profile}, {"used", row.used}, {"packed", row.packed}, {"fixed", row.fixed}});
  for (const MabErrorRow& row : result.errors)
    json["errors"].push_back(ordered_json{{"profile", row.profile},
                                          {"volume", row.volume},
                                          {"map", row.map},
                                          {"ray_share", row.ray_share},
                                          {"dssim", row.dssim},
                                          {"weighted_rmse", row.weighted_rmse}});
  for (const MabMapRow& row : result.maps)
    json["lens_over_radius"].push_back(ordered_json{{"profile", row.profile},
                                                    {"volume", row.volume},
                                                    {"mean", row.ratio_mean},
                                                    {"worst", row.ratio_worst},
                                                    {"weighted_mean", row.weighted_mean},
                                                    {"weighted_worst", row.weighted_worst}});
  for (const MabTimeRow& row : result.times)
    json["times"].push_back(ordered_json{{"map", row.map},
                                         {"scheme", row.scheme},
                                         {"ray_share", row.ray_share},
                                         {"time_share", row.time_share}});
  for (const MabControlRow& row : result.controls)
    json["controls"].push_back(ordered_json{{"control", row.control},
                                            {"missed_percent", row.missed_percent},
                                            {"longest_run", row.longest_run},
                                            {"ray_share_mean", row.ray_share_mean},
                                            {"load", row.load},
                                            {"schedule", row.schedule},
                                            {"repeated_percent", row.repeated_percent},
                                            {"longest_repeats", row.longest_repeats}});
  return json.dump(2);
}

}  // namespace brace
