#include "tools/live/view_panel.hpp"

#include <fmt/core.h>
#include <imgui.h>

namespace brace {

namespace {

ImU32 packed(Rgba8 colour) {
  return IM_COL32(colour.r, colour.g, colour.b, 255);
}

void draw_scale(const ViewLegend& legend) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 12.0f;
  const int parts = 64;
  for (int i = 0; i < parts; ++i) {
    const float left = at.x + width * static_cast<float>(i) / parts;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(left, at.y), ImVec2(left + width / parts, at.y + height),
                                              packed(scale_colour((i + 0.5) / parts)));
  }
  ImGui::Dummy(ImVec2(width, height));
  ImGui::TextUnformatted(legend.low.c_str());
  ImGui::SameLine(width - ImGui::CalcTextSize(legend.high.c_str()).x);
  ImGui::TextUnformatted(legend.high.c_str());
}

void draw_swatches(const ViewLegend& legend) {
  for (const auto& [colour, words] : legend.swatches) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddRectFilled(at, ImVec2(at.x + 12.0f, at.y + 12.0f), packed(colour));
    ImGui::Dummy(ImVec2(12.0f, 12.0f));
    ImGui::SameLine();
    ImGui::TextUnformatted(words.c_str());
    ImGui::SameLine();
  }
  ImGui::NewLine();
}

}  // namespace

std::optional<ViewKind> view_panel(Overlay& overlay, ViewKind now, const ViewLegend& legend) {
  std::optional<ViewKind> chosen;
  ImGui::SetNextItemWidth(-1.0f);
  const bool open = ImGui::BeginCombo("##view", fmt::format("view: {}", name_of(now)).c_str());
  overlay.note_place("view");
  if (open) {
    for (std::size_t i = 0; i < view_names.size(); ++i) {
      const auto kind = static_cast<ViewKind>(i);
      if (ImGui::Selectable(fmt::format("{} ({})", view_names[i], i + 1).c_str(), kind == now) && kind != now)
        chosen = kind;
      overlay.note_place(std::string("view=") + view_names[i]);
    }
    ImGui::EndCombo();
  }
  if (!legend.words.empty()) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(legend.words.c_str());
    ImGui::PopTextWrapPos();
  }
  if (!legend.high.empty()) draw_scale(legend);
  if (!legend.swatches.empty()) draw_swatches(legend);
  return chosen;
}

}  // namespace brace
