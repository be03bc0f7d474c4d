#include <algorithm>

#include <fmt/format.h>

#include "runtime/plan/scene_facts.hpp"

namespace brace {

namespace {

std::string coefficients_text(const sim::LensChannel& channel) {
  std::size_t used = channel.k.size();
  while (used > 1 && channel.k[used - 1] == 0.0)
    --used;
  std::string text;
  for (std::size_t i = 0; i < used; ++i)
    text += fmt::format("{}{:.4g}", i == 0 ? "" : ", ", channel.k[i]);
  return text;
}

void add_lens(const SceneFacts& facts, std::vector<FactLine>& lines) {
  const sim::EyeLens& left = facts.lenses[0];
  const std::string kind(sim::to_string(left.kind));
  if (left.kind == sim::LensKind::identity || left.kind == sim::LensKind::none_published) {
    lines.push_back({"lens", kind + ", does nothing"});
    return;
  }
  if (facts.channels_equal) {
    lines.push_back({"lens", kind + ", all channels: " + coefficients_text(left.rgb[0])});
    return;
  }
  static const char* const channels[] = {"red", "green", "blue"};
  static const char* const eyes[] = {"left", "right"};
  for (std::size_t eye = 0; eye < 2; ++eye)
    for (std::size_t i = 0; i < 3; ++i)
      lines.push_back({fmt::format("lens, {} {}", eyes[eye], channels[i]),
                       kind + ": " + coefficients_text(facts.lenses[eye].rgb[i])});
}

void add_volume(const VolumeFacts& volume, std::vector<FactLine>& lines) {
  lines.push_back(
      {"occupancy", fmt::format("{:.3f} of the blocks have something visible", volume.occupancy)});
  if (volume.visible_values == 0.0 && volume.kappa_dt_max == 0.0) {
    lines.push_back({"transfer function", "nothing is visible"});
    return;
  }
  lines.push_back(
      {"transfer function", fmt::format("{:.3f} of the data's values are visible, {:.4g} … {:.4g}",
                                        volume.visible_values, volume.visible.min, volume.visible.max)});
  lines.push_back(
      {"kappa dt", fmt::format("{:.3g} … {:.3g} where visible", volume.kappa_dt_min, volume.kappa_dt_max)});
}

}  // namespace

std::vector<FactLine> fact_lines(const SceneFacts& facts) {
  std::vector<FactLine> lines;
  if (facts.volume) add_volume(*facts.volume, lines);
  if (const auto disparity_px = facts.disparity_px())
    lines.push_back({"disparity",
                     fmt::format("{:.2f} px over the volume (of the eye frame as rendered), from {:.2f} m on",
                                 *disparity_px, facts.volume_distance_m)});
  lines.push_back(
      {"head", fmt::format("{:.1f} deg/s (p95), {:.2f} px/deg", facts.head_deg_s, facts.px_per_deg)});
  lines.push_back({"scan-out", fmt::format("{}: the view moves by {:.2f} px (p95) in {:.2f} ms",
                                           sim::to_string(facts.scan_direction), facts.scan_out_px(),
                                           facts.scan_out_ms)});
  add_lens(facts, lines);
  return lines;
}

}  // namespace brace
