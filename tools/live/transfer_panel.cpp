#include "tools/live/transfer_panel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

namespace brace {

namespace {

constexpr int plot_height_px = 120, bins = 128;
constexpr float grip_px = 9.0f;  // a point is taken from this near

float height_of(double kappa) {
  return static_cast<float>(std::sqrt(opacity_from_kappa(kappa, 1.0)));
}

ImU32 colour_of_sample(const TransferSample& sample) {
  const auto channel = [](double v) {
    return static_cast<int>(std::lround(255.0 * std::clamp(v, 0.0, 1.0)));
  };
  return IM_COL32(channel(sample.r), channel(sample.g), channel(sample.b), 255);
}

void draw_plot(const TransferFunction& function, const std::vector<float>& bars, std::size_t selected,
               const WindowRect& plot, ValueRange range) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const auto left = static_cast<float>(plot.x), top = static_cast<float>(plot.y);
  const auto width = static_cast<float>(plot.width), height = static_cast<float>(plot.height);
  draw.AddRectFilled(ImVec2(left, top), ImVec2(left + width, top + height), IM_COL32(0, 0, 0, 255));
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const float from = left + width * static_cast<float>(i) / static_cast<float>(bars.size());
    const float to = left + width * static_cast<float>(i + 1) / static_cast<float>(bars.size());
    draw.AddRectFilled(ImVec2(from, top + height * (1.0f - bars[i])), ImVec2(to, top + height),
                       IM_COL32(70, 75, 90, 255));
  }
  for (int x = 0; x < plot.width; ++x) {
    const double value = range.min + (range.max - range.min) * (x + 0.5) / plot.width;
    const TransferSample sample = evaluate(function, value);
    const float y = top + height * (1.0f - height_of(sample.kappa));
    const float at = left + static_cast<float>(x);
    draw.AddRectFilled(ImVec2(at, y - 1.0f), ImVec2(at + 1.0f, y + 2.0f), colour_of_sample(sample));
    draw.AddRectFilled(ImVec2(at, top + height - 6.0f), ImVec2(at + 1.0f, top + height),
                       colour_of_sample(sample));
  }
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    const std::array<float, 2> at = place_of(function.points[i], plot, range);
    const float size = i == selected ? 5.0f : 4.0f;
    draw.AddRectFilled(ImVec2(at[0] - size, at[1] - size), ImVec2(at[0] + size, at[1] + size),
                       i == selected ? IM_COL32(255, 255, 255, 255) : IM_COL32(150, 150, 160, 255));
    draw.AddRectFilled(ImVec2(at[0] - size + 2, at[1] - size + 2), ImVec2(at[0] + size - 2, at[1] + size - 2),
                       colour_of_sample(function.points[i].sample));
  }
}

/// The point under the mouse, or the number of points.
std::size_t point_at(const TransferFunction& function, const WindowRect& plot, ValueRange range,
                     ImVec2 mouse) {
  std::size_t nearest = function.points.size();
  float least = grip_px;
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    const std::array<float, 2> at = place_of(function.points[i], plot, range);
    const float away = std::max(std::abs(at[0] - mouse.x), std::abs(at[1] - mouse.y));
    if (away < least) least = away, nearest = i;
  }
  return nearest;
}

}  // namespace

std::array<float, 2> place_of(const TransferPoint& point, const WindowRect& plot, ValueRange range) {
  const double across = std::clamp((point.value - range.min) / (range.max - range.min), 0.0, 1.0);
  return {
      static_cast<float>(plot.x + plot.width * across),
      static_cast<float>(plot.y) + static_cast<float>(plot.height) * (1.0f - height_of(point.sample.kappa))};
}

void TransferPanel::follow_mouse(TransferFunction& function, const WindowRect& plot, ValueRange range,
                                 Change& change) {
  const ImVec2 mouse = ImGui::GetMousePos();
  const double value =
      range.min + (range.max - range.min) * (static_cast<double>(mouse.x) - plot.x) / plot.width;
  const double up = std::clamp((plot.y + plot.height - static_cast<double>(mouse.y)) / plot.height, 0.0, 1.0);
  const std::size_t under = point_at(function, plot, range, mouse);
  if (ImGui::IsItemActivated()) {
    dragging_ = under < function.points.size();
    if (dragging_) selected_ = under;
  }
  const bool hovered = ImGui::IsItemHovered();
  if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && under == function.points.size()) {
    selected_ = add_point(function, value, range);
    move_point(function, selected_, value, up * up, range);
    dragging_ = true;
    change.edited = function;
  } else if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Right) && under < function.points.size()) {
    remove_point(function, under);
    selected_ = 0;
    change.edited = function;
  } else if (dragging_ && ImGui::IsItemActive() && ImGui::IsMouseDragging(ImGuiMouseButton_Left, 1.0f)) {
    move_point(function, selected_, value, up * up, range);
    change.edited = function;
  }
  if (!ImGui::IsItemActive()) dragging_ = false;
}

TransferPanel::Change TransferPanel::show(Overlay& overlay, const TransferFunction& resolved,
                                          const VoxelStatistics& statistics, ValueRange range) {
  Change change;
  TransferFunction function = resolved;
  if (bars_.empty() || bars_voxels_ != statistics.voxels || bars_range_.min != range.min ||
      bars_range_.max != range.max) {
    bars_ = log_bars(statistics, range, bins);
    bars_voxels_ = statistics.voxels;
    bars_range_ = range;
  }
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const WindowRect plot{static_cast<int>(at.x), static_cast<int>(at.y),
                        static_cast<int>(ImGui::GetContentRegionAvail().x), plot_height_px};
  ImGui::InvisibleButton("plot", ImVec2(static_cast<float>(plot.width), static_cast<float>(plot.height)),
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
  overlay.note_place("transfer.plot");
  follow_mouse(function, plot, range, change);
  selected_ = std::min(selected_, function.points.size() - 1);
  draw_plot(function, bars_, selected_, plot, range);
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    const std::array<float, 2> point_at = place_of(function.points[i], plot, range);
    overlay.note_place(fmt::format("transfer.point.{}", i),
                       {static_cast<int>(point_at[0]) - 4, static_cast<int>(point_at[1]) - 4, 8, 8});
  }

  TransferPoint& point = function.points[selected_];
  ImGui::TextUnformatted(fmt::format("{:g} to {:g}; bars: log of the voxels", range.min, range.max).c_str());
  ImGui::TextUnformatted(fmt::format("point {} of {}: value {:g}, opacity {:.4f}", selected_ + 1,
                                     function.points.size(), point.value,
                                     opacity_from_kappa(point.sample.kappa, 1.0))
                             .c_str());
  std::array<float, 3> rgb = {static_cast<float>(point.sample.r), static_cast<float>(point.sample.g),
                              static_cast<float>(point.sample.b)};
  ImGui::SetNextItemWidth(-1.0f);
  if (ImGui::ColorEdit3("##colour", rgb.data(), ImGuiColorEditFlags_Float)) {
    point.sample = {rgb[0], rgb[1], rgb[2], point.sample.kappa};
    change.edited = function;
  }
  overlay.note_place("transfer.colour");
  if (ImGui::Button("save as")) change.save_as = file_;
  overlay.note_place("transfer.save");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0f);
  ImGui::InputText("##file", &file_);
  overlay.note_place("transfer.file");
  return change;
}

}  // namespace brace
