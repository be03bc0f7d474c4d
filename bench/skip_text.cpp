#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/median.hpp"
#include "bench/skip.hpp"

namespace brace {

namespace {

std::string stands_for(const std::string& scene) {
  return scene == "head" ? "manix" : scene == "insect" ? "stag beetle" : scene == "snake" ? "kingsnake" : "";
}

/// A figure of the published table: quantity update_ms or init_ms; column 0 the distance map, 1 … 5 the
/// partitions 16 … 256. Negative if it has none.
double published_ms(const SkipBenchResult& result, const std::string& scene, const std::string& quantity,
                    const std::string& tf, int column) {
  const std::string start = stands_for(scene) + ",";
  for (const std::string& line : result.published) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == ',') {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    const auto at = static_cast<std::size_t>(4 + column);
    if (line.starts_with(start) && cells.size() > at && cells[2] == quantity && cells[3] == tf &&
        !cells[at].empty())
      return std::stod(cells[at]);
  }
  return -1;
}

int column_of(int partitions) {
  for (int column = 1, n = 16; column <= 5; ++column, n *= 2)
    if (n == partitions) return column;
  return -1;
}

std::string cell(double value) {
  return value < 0 ? fmt::format("{:>9}", "-") : fmt::format("{:9.2f}", value);
}

std::string ratio(double rival, double ours) {
  return rival < 0 || ours <= 0 ? fmt::format("{:>8}", "-") : fmt::format("{:7.1f}x", rival / ours);
}

/// From the volume, or from 64 partitions' bits.
double best_recomputation_ms(const SkipUpdateRow& row) {
  return row.bitmask_ms > 0 ? std::min(row.recomputed_ms, row.bitmask_ms) : row.recomputed_ms;
}

std::string inits_text(const SkipBenchResult& result) {
  std::string text = fmt::format("{:8}{:>5}{:>11}{:>15}{:>9}{:>11}{:>12}{:>14}\n", "scene", "n", "all ms",
                                 "n single ms", "ratio", "maps MB", "bitmask MB", "published ms");
  for (const SkipInitRow& row : result.inits) {
    const int column = column_of(row.partitions);
    const double singles = row.single_ms * row.partitions;
    text +=
        fmt::format("{:8}{:5}{:11.0f}{:15.0f}{:>9}{:11.1f}{:12.1f}{:>14}\n", row.scene, row.partitions,
                    row.all_ms, singles, ratio(singles, row.all_ms), row.memory_mb, row.bitmask_mb,
                    cell(column < 0 ? -1 : published_ms(result, row.scene, "init_ms", "TF1-TF6", column)));
  }
  return text;
}

std::string updates_text(const SkipBenchResult& result) {
  std::string text =
      fmt::format("{:8}{:>4}{:>10}{:>11}{:>9}{:>9} |{:>5}{:>6}{:>9}{:>9}{:>9}{:>8} |{:>9}{:>9}{:>9}{:>9}\n",
                  "scene", "TF", "published", "recompute", "block", "bitmask", "n", "maps", "merge", "tree",
                  "paper's", "GB/s", "publ./m", "reco./m", "paper/best", "RTX4090");
  for (const SkipUpdateRow& row : result.updates) {
    const std::string left =
        fmt::format("{:8}{:>4}{:10.1f}{:11.1f}{:9.2f}{}", row.scene, fmt::format("TF{}", row.tf),
                    row.published_ms, row.recomputed_ms, row.block_ms, cell(row.bitmask_ms));
    for (const auto& merge : row.merges) {
      const std::string tf = fmt::format("TF{}", row.tf);
      const int column = column_of(merge.partitions);
      const double published = published_ms(result, row.scene, "update_ms", tf, column < 0 ? 0 : column);
      const double best = merge.tree_ms >= 0 ? std::min(merge.tree_ms, merge.merge_ms) : merge.merge_ms;
      text += fmt::format("{} |{:5}{:6}{:9.2f}{}{}{:8.1f} |{:>9}{:>9}{:>9}{:>9}\n", left, merge.partitions,
                          merge.maps, merge.merge_ms, cell(merge.tree_ms), cell(merge.paper_ms),
                          merge.gb_per_s, ratio(row.published_ms, merge.merge_ms),
                          ratio(best_recomputation_ms(row), merge.merge_ms), ratio(merge.paper_ms, best),
                          ratio(published_ms(result, row.scene, "update_ms", tf, 0), published));
    }
  }
  return text;
}

std::string medians_text(const SkipBenchResult& result) {
  std::vector<double> as_published, as_recomputed, in_paper;
  for (const SkipUpdateRow& row : result.updates) {
    for (const auto& merge : row.merges) {
      const std::string tf = fmt::format("TF{}", row.tf);
      const double best = merge.tree_ms >= 0 ? std::min(merge.tree_ms, merge.merge_ms) : merge.merge_ms;
      as_published.push_back(row.published_ms / best);
      as_recomputed.push_back(best_recomputation_ms(row) / best);
      const int column = column_of(merge.partitions);
      if (column > 0)
        in_paper.push_back(published_ms(result, row.scene, "update_ms", tf, 0) /
                           published_ms(result, row.scene, "update_ms", tf, column));
    }
  }
  return fmt::format(
      "Median ratio of an update over {} cells: {:.1f}x against the method as published, {:.1f}x against our "
      "best\n"
      "recomputation; the paper's own (RTX 4090): {:.1f}x.\n",
      as_published.size(), median(as_published), median(as_recomputed), median(in_paper));
}

std::string frames_text(const SkipBenchResult& result) {
  std::string text = fmt::format("{:34}{:>5}  {:30}{:>10}{:>14}{:>9}{:>11}{:>11}\n", "scene", "TF",
                                 "structure", "ms", "ms to the end", "ratio", "M samples", "M look-ups");
  double none_ms = 0;
  for (const SkipFrameRow& row : result.frames) {
    for (const SkipFrameRow& other : result.frames)
      if (other.scene == row.scene && other.tf == row.tf && other.stage == "none") none_ms = other.ms;
    text += fmt::format("{:34}{:>5}  {:30}{:10.2f}{:14.2f}{:>9}{:11.2f}{:11.2f}{}\n", row.scene,
                        row.tf == 0 ? "1 %" : fmt::format("TF{}", row.tf), row.stage, row.ms,
                        row.ms_without_termination, ratio(none_ms, row.ms), row.samples_m, row.skip_steps_m,
                        row.chosen ? "  auto" : "");
  }
  return text;
}

std::string thresholds_text(const SkipBenchResult& result) {
  std::string text = fmt::format("{:8}{:>11}{:>10}{:>10}{:>15}{:>13}{:>16}\n", "content", "occupied %",
                                 "none ms", "block ms", "distance_map ms", "none/block", "none/distance");
  for (const SkipThresholdRow& row : result.thresholds)
    text += fmt::format("{:8}{:11.1f}{:10.2f}{:10.2f}{:15.2f}{:12.2f}x{:15.2f}x\n", row.content,
                        100.0 * row.occupied, row.none_ms, row.block_ms, row.distance_ms,
                        row.none_ms / row.block_ms, row.none_ms / row.distance_ms);
  return text;
}

std::string octants_text(const SkipBenchResult& result) {
  std::string text = fmt::format("{:8}{:>4}{:>22}{:>22}{:>8}\n", "scene", "TF", "one for all directions",
                                 "one per octant", "ratio");
  for (const SkipOctantRow& row : result.octants)
    text += fmt::format("{:8}{:4}{:22.1f}{:22.1f}{:7.2f}x\n", row.scene, row.tf, row.leaps_all,
                        row.leaps_octant, row.leaps_all / row.leaps_octant);
  return text;
}

}  // namespace

std::string to_text(const SkipBenchResult& result) {
  std::string text =
      fmt::format("Device: {}; load of the host {:.1f}; copy {:.1f} GB/s (read and written)\n\n",
                  result.device, result.host_load, result.copy_gb_per_s);
  if (!result.inits.empty())
    text +=
        "Initialisation: all partitions at once against n builds as published\n" + inits_text(result) + "\n";
  if (!result.updates.empty())
    text += "Update at a change of the transfer function, ms on the device\n" + updates_text(result) + "\n" +
            medians_text(result) + "\n";
  if (!result.frames.empty())
    text += "Frames, mean over two rotations; ratio to none; auto: what skip/auto takes\n" +
            frames_text(result) + "\n";
  if (!result.thresholds.empty())
    text +=
        "Where skipping stops to pay: frames over the share of occupied blocks\n" + thresholds_text(result);
  if (!result.octants.empty())
    text +=
        "\nLeaps per ray over empty blocks; a distance per octant takes eight times the memory and "
        "transforms\n" +
        octants_text(result);
  return text;
}

std::string to_json(const SkipBenchResult& result) {
  nlohmann::ordered_json json;
  json["device"] = result.device;
  json["host_load"] = result.host_load;
  json["copy_gb_per_s"] = result.copy_gb_per_s;
  for (const SkipInitRow& row : result.inits)
    json["init"].push_back({{"scene", row.scene},
                            {"partitions", row.partitions},
                            {"all_ms", row.all_ms},
                            {"single_ms", row.single_ms},
                            {"memory_mb", row.memory_mb},
                            {"bitmask_mb", row.bitmask_mb}});
  for (const SkipUpdateRow& row : result.updates) {
    nlohmann::ordered_json update = {{"scene", row.scene},
                                     {"tf", row.tf},
                                     {"published_ms", row.published_ms},
                                     {"recomputed_ms", row.recomputed_ms},
                                     {"block_ms", row.block_ms},
                                     {"bitmask_ms", row.bitmask_ms}};
    for (const auto& merge : row.merges)
      update["merges"].push_back({{"partitions", merge.partitions},
                                  {"maps", merge.maps},
                                  {"merge_ms", merge.merge_ms},
                                  {"tree_ms", merge.tree_ms},
                                  {"paper_ms", merge.paper_ms},
                                  {"gb_per_s", merge.gb_per_s}});
    json["update"].push_back(update);
  }
  for (const SkipFrameRow& row : result.frames)
    json["frames"].push_back({{"scene", row.scene},
                              {"tf", row.tf},
                              {"stage", row.stage},
                              {"ms", row.ms},
                              {"ms_without_termination", row.ms_without_termination},
                              {"samples_m", row.samples_m},
                              {"skip_steps_m", row.skip_steps_m},
                              {"chosen", row.chosen}});
  for (const SkipThresholdRow& row : result.thresholds)
    json["thresholds"].push_back({{"content", row.content},
                                  {"occupied", row.occupied},
                                  {"none_ms", row.none_ms},
                                  {"block_ms", row.block_ms},
                                  {"distance_ms", row.distance_ms}});
  for (const SkipOctantRow& row : result.octants)
    json["octants"].push_back({{"scene", row.scene},
                               {"tf", row.tf},
                               {"leaps_all", row.leaps_all},
                               {"leaps_octant", row.leaps_octant}});
  return json.dump(2);
}

}  // namespace brace
