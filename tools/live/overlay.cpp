#include "tools/live/overlay.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <imgui.h>

namespace brace {

Overlay::Overlay() : context_(ImGui::CreateContext()) {
  ImGuiIO& io = ImGui::GetIO();
  io.MouseDoubleClickTime = 0.5f;                    // pictures may be slow to come
  io.IniFilename = nullptr;                          // leaves no file behind
  io.Fonts->Flags |= ImFontAtlasFlags_NoBakedLines;  // they need filtered texels
  io.Fonts->AddFontDefault();
  unsigned char* coverage = nullptr;
  io.Fonts->GetTexDataAsAlpha8(&coverage, &font_.width_px, &font_.height_px);
  font_.coverage = coverage;
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = style.FrameRounding = style.GrabRounding = style.ScrollbarRounding = 0.0f;
  style.WindowBorderSize = 0.0f;
  style.AntiAliasedFill = false;  // upright rectangles, which are cheap, are sharp as they are
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.08f, 0.08f, 0.10f, 1.0f);
}

Overlay::~Overlay() {
  ImGui::DestroyContext(context_);
}

void Overlay::begin(int width_px, int height_px, double seconds) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(width_px), static_cast<float>(height_px));
  io.DeltaTime = static_cast<float>(std::clamp(seconds, 1e-4, 1.0));
  places_.clear();
  ImGui::NewFrame();
}

void Overlay::end(ImageRgba8& onto) {
  ImGui::Render();
  paint(*ImGui::GetDrawData(), font_, onto);
}

bool Overlay::wants_mouse() const {
  return ImGui::GetIO().WantCaptureMouse;
}

bool Overlay::wants_keys() const {
  return ImGui::GetIO().WantTextInput;
}

bool Overlay::begin_panel(const char* name, const WindowRect& rect) {
  in_panel_ = rect.width > 0 && rect.height > 0;
  if (!in_panel_) return false;
  ImGui::SetNextWindowPos(ImVec2(static_cast<float>(rect.x), static_cast<float>(rect.y)));
  ImGui::SetNextWindowSize(ImVec2(static_cast<float>(rect.width), static_cast<float>(rect.height)));
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  return true;
}

void Overlay::end_panel() {
  if (in_panel_) ImGui::End();
  in_panel_ = false;
}

bool Overlay::heading(const char* name, bool open_at_first) {
  const bool open =
      ImGui::CollapsingHeader(name, open_at_first ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
  note_place(name);
  return open;
}

void Overlay::note_place(const std::string& name) {
  if (!ImGui::IsItemVisible()) return;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  places_[name] = {static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(high.x - low.x),
                   static_cast<int>(high.y - low.y)};
}

std::string places_text(const WidgetPlaces& places) {
  std::string text;
  for (const auto& [name, at] : places)
    text += fmt::format("{} {} {} {} {}\n", at.x, at.y, at.width, at.height, name);
  return text;
}

}  // namespace brace
