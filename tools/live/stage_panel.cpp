#include "tools/live/stage_panel.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <imgui.h>

#include "base/suggest.hpp"

namespace brace {

namespace {

constexpr float label_width_px = 175.0f;

/// A label to the left of a widget that fills the line.
void label(const std::string& words, const std::string& help) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(words.c_str());
  if (ImGui::IsItemHovered() && !help.empty()) {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(380.0f);
    ImGui::TextUnformatted(help.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
  ImGui::SameLine(label_width_px);
  ImGui::SetNextItemWidth(-1.0f);
}

/// The index chosen anew, or -1.
int combo(Overlay& overlay, const std::string& place, const std::vector<std::string>& words, int now) {
  const std::string id = "##" + place;
  const std::string& shown = words[static_cast<std::size_t>(now)];
  const bool open = ImGui::BeginCombo(id.c_str(), shown.c_str());
  overlay.note_place(place);
  if (!open) return -1;
  int chosen = -1;
  for (int i = 0; i < static_cast<int>(words.size()); ++i) {
    const std::string& word = words[static_cast<std::size_t>(i)];
    if (ImGui::Selectable(word.c_str(), i == now) && i != now) chosen = i;
    overlay.note_place(place + "=" + word);
  }
  ImGui::EndCombo();
  return chosen;
}

/// Ranges over more than two decades are easier to hit by their logarithm.
ImGuiSliderFlags slider_flags(const StageParameter& parameter) {
  const bool wide = parameter.maximum - parameter.minimum > 100.0 && parameter.minimum >= 0.0;
  const bool decades = parameter.minimum > 0.0 && parameter.maximum / parameter.minimum > 100.0;
  return ImGuiSliderFlags_AlwaysClamp | (wide || decades ? ImGuiSliderFlags_Logarithmic : 0);
}

/// As part of a format of printf.
std::string escaped(const std::string& words) {
  std::string safe;
  for (const char c : words)
    safe += c == '%' ? std::string("%%") : std::string(1, c);
  return safe;
}

}  // namespace

std::string accepted_of(const StageParameter& parameter) {
  if (parameter.type == ParameterType::choice) return join(parameter.choices);
  if (parameter.type == ParameterType::boolean) return "true or false";
  return fmt::format("{}{:g} to {:g}", parameter.unit.empty() ? "" : parameter.unit + ", ", parameter.minimum,
                     parameter.maximum);
}

std::string value_text(const StageParameter& parameter, double value) {
  switch (parameter.type) {
    case ParameterType::choice:
      return parameter.choices[static_cast<std::size_t>(value)];
    case ParameterType::boolean:
      return value != 0.0 ? "true" : "false";
    case ParameterType::integer:
      return fmt::format("{:.0f}", value);
    case ParameterType::floating:
      break;
  }
  return fmt::format("{:.6g}", value);
}

std::optional<Setting> StagePanel::show_parameter(Overlay& overlay, const PipelineStage& chosen,
                                                  std::size_t index) {
  const StageParameter& parameter = chosen.stage.parameters[index];
  const double now = chosen.values[index];
  const std::string place = chosen.stage.id() + "." + parameter.name;
  const std::string key = "stage." + place, id = "##" + place;
  label(parameter.name, parameter.help + " (" + accepted_of(parameter) + ")");
  if (parameter.type == ParameterType::choice) {
    const int picked = combo(overlay, place, parameter.choices, static_cast<int>(now));
    if (picked < 0) return std::nullopt;
    return Setting{key, parameter.choices[static_cast<std::size_t>(picked)]};
  }
  if (parameter.type == ParameterType::boolean) {
    bool on = now != 0.0;
    const bool turned = ImGui::Checkbox(id.c_str(), &on);
    overlay.note_place(place);
    if (!turned) return std::nullopt;
    return Setting{key, on ? "true" : "false"};
  }
  double value = edited_ == key ? value_ : now;
  const std::string format = (parameter.type == ParameterType::integer ? "%.0f" : "%.4g") +
                             escaped(fmt::format("{}{}  [{:g}, {:g}]", parameter.unit.empty() ? "" : " ",
                                                 parameter.unit, parameter.minimum, parameter.maximum));
  const bool moved = ImGui::SliderScalar(id.c_str(), ImGuiDataType_Double, &value, &parameter.minimum,
                                         &parameter.maximum, format.c_str(), slider_flags(parameter));
  overlay.note_place(place);
  if (moved) {
    edited_ = key;
    value_ = parameter.type == ParameterType::integer ? std::round(value) : value;
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", accepted_of(parameter).c_str());
  if (edited_ != key || ImGui::IsItemActive()) return std::nullopt;
  edited_.clear();
  if (value_text(parameter, value_) == value_text(parameter, now)) return std::nullopt;
  return Setting{key, value_text(parameter, value_)};
}

std::optional<Setting> StagePanel::show(Overlay& overlay,
                                        const std::map<std::string, PipelineStage>& pipeline,
                                        const std::vector<StageInfo>& stages,
                                        const std::map<std::string, std::string>& notes) {
  std::optional<Setting> setting;
  for (const std::string& family : stage_families()) {
    const auto chosen = pipeline.find(family);
    if (chosen == pipeline.end() || family == "cost") continue;
    std::vector<std::string> names;
    for (const StageInfo& stage : stages)
      if (stage.family == family) names.push_back(stage.name);
    const StageInfo& now = chosen->second.stage;
    const auto at = std::find(names.begin(), names.end(), now.name);
    if (at == names.end()) continue;  // its file has gone, but it goes on
    label(family, now.help);
    const int picked = combo(overlay, "pipeline." + family, names, static_cast<int>(at - names.begin()));
    if (picked >= 0) setting = {"pipeline." + family, names[static_cast<std::size_t>(picked)]};
    if (const auto note = notes.find(family); note != notes.end()) {
      ImGui::PushTextWrapPos(0.0f);
      ImGui::TextDisabled("%s", note->second.c_str());
      ImGui::PopTextWrapPos();
    }
    if (now.parameters.empty()) continue;
    const std::string heading = fmt::format("{}: {} parameters", now.id(), now.parameters.size());
    const bool open = ImGui::TreeNode(now.id().c_str(), "%s", heading.c_str());
    overlay.note_place(now.id());
    if (!open) continue;
    for (std::size_t i = 0; i < now.parameters.size(); ++i)
      if (const auto changed = show_parameter(overlay, chosen->second, i)) setting = changed;
    ImGui::TreePop();
  }
  return setting;
}

}  // namespace brace
