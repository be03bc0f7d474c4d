#include "tools/live/overlay_figures.hpp"

#include <algorithm>
#include <array>

#include <fmt/core.h>
#include <imgui.h>

namespace brace {

namespace {

const ImVec4 red(1.0f, 0.35f, 0.3f, 1.0f), grey(0.6f, 0.6f, 0.65f, 1.0f);

void text(const std::string& words) {
  ImGui::TextUnformatted(words.c_str(), words.c_str() + words.size());
}

void wrapped(const std::string& words, const ImVec4& colour) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::PushTextWrapPos(0.0f);
  text(words);
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

/// 12,345,678 as 12.3 M.
std::string short_count(double value) {
  if (value >= 1e6) return fmt::format("{:.2f} M", value * 1e-6);
  if (value >= 1e4) return fmt::format("{:.1f} k", value * 1e-3);
  return fmt::format("{:.0f}", value);
}

bool begin_table(const char* name, std::initializer_list<const char*> columns) {
  if (!ImGui::BeginTable(name, static_cast<int>(columns.size()), ImGuiTableFlags_SizingStretchProp))
    return false;
  ImGui::TableSetupColumn(*columns.begin(), ImGuiTableColumnFlags_WidthStretch, 2.4f);
  for (const char* const* column = columns.begin() + 1; column != columns.end(); ++column)
    ImGui::TableSetupColumn(*column, ImGuiTableColumnFlags_WidthStretch, 1.0f);
  ImGui::TableNextRow();
  for (const char* column : columns) {
    ImGui::TableNextColumn();
    ImGui::TextColored(grey, "%s", column);
  }
  return true;
}

template <class Figure>
void latency_row(const char* name, const FrameHistory& history, const Figure& figure) {
  const Distribution all = history.over_recent(figure);
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  text(name);
  for (const double value : {figure(history.recent().back()), all.p50, all.p99}) {
    ImGui::TableNextColumn();
    text(fmt::format("{:.1f} ms", value));
  }
}

void latencies(const FrameHistory& history) {
  if (!begin_table("latency", {"latency", "now", "p50", "p99"})) return;
  latency_row("to photon, rotation", history, [](const LiveFrame& f) { return f.mtp_rotation_ms; });
  latency_row("to photon, translation", history, [](const LiveFrame& f) { return f.mtp_translation_ms; });
  latency_row("frame age", history, [](const LiveFrame& f) { return f.frame_age_ms; });
  latency_row("interval", history, [](const LiveFrame& f) { return f.interval_ms; });
  ImGui::EndTable();
}

void work_row(const char* name, std::uint64_t count, std::uint64_t rays) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  text(name);
  ImGui::TableNextColumn();
  text(short_count(static_cast<double>(count)));
  ImGui::TableNextColumn();
  text(rays > 0 ? fmt::format("{:.1f}", static_cast<double>(count) / static_cast<double>(rays)) : "-");
}

void work(const WorkCounts& counts) {
  if (!begin_table("work", {"work of both eyes", "count", "per ray"})) return;
  work_row("rays", counts.rays, counts.rays);
  work_row("samples", counts.samples, counts.rays);
  work_row("skip steps", counts.skip_steps, counts.rays);
  work_row("shading fetches", counts.shading_fetches, counts.rays);
  ImGui::EndTable();
}

struct CostRow {
  const char* name;
  double LiveCosts::*cost;
};
constexpr std::array cost_rows = {CostRow{"rays: opening", &LiveCosts::opening},
                                  CostRow{"cast, skip", &LiveCosts::cast},
                                  CostRow{"rays: closing", &LiveCosts::closing},
                                  CostRow{"warp, lens", &LiveCosts::warp},
                                  CostRow{"view", &LiveCosts::view},
                                  CostRow{"host: read back", &LiveCosts::read},
                                  CostRow{"host: window", &LiveCosts::paint},
                                  CostRow{"host: show", &LiveCosts::present}};

void costs(const FrameHistory& history, double period_ms) {
  if (!begin_table("costs", {"cost", "p50", "p99", "period"})) return;
  for (const CostRow& row : cost_rows) {
    const Distribution all =
        history.over_recent([&](const LiveFrame& frame) { return frame.costs.*row.cost; });
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    text(row.name);
    for (const double value : {all.p50, all.p99}) {
      ImGui::TableNextColumn();
      text(fmt::format("{:.2f} ms", value));
    }
    ImGui::TableNextColumn();
    const auto share = static_cast<float>(std::clamp(all.p50 / period_ms, 0.0, 1.0));
    ImGui::ProgressBar(share, ImVec2(-1.0f, ImGui::GetTextLineHeight()), "");
  }
  ImGui::EndTable();
}

}  // namespace

void facts_panel(const OverlayFacts& facts, const FrameHistory& history) {
  text(fmt::format("{}, {:.1f} fps at {:g} Hz", facts.session, history.rate_hz(), facts.rate_hz));
  text(fmt::format("{} x {} px per eye, head: {}{}", facts.eye_width_px, facts.eye_height_px, facts.head,
                   facts.recording ? ", recording" : ""));
  wrapped(facts.device, grey);
}

void figures_panel(Overlay& overlay, const OverlayFacts& facts, const FrameHistory& history) {
  if (history.empty() || !overlay.heading("Figures", true)) return;
  latencies(history);
  work(history.recent().back().work);
  costs(history, 1e3 / facts.rate_hz);
}

namespace {

/// What went wrong, or was done last: where it moves no widget.
void words(Overlay& overlay, const OverlayFacts& facts) {
  if (!facts.fault.empty()) {
    wrapped(facts.fault, red);
    overlay.note_place("fault");
  } else {
    wrapped(facts.message.empty() ? "H hides this, Esc ends; drag with the mouse to look" : facts.message,
            grey);
  }
}

/// Bars from the newest at the right edge leftwards; the whole of kept_s fits.
void draw_bars(const FrameHistory& history, double period_ms, const ImVec2& at, const ImVec2& size) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const double shown_ms = 4.0 * period_ms;  // what the height stands for
  const auto y_of = [&](double ms) {
    return at.y + size.y - static_cast<float>(std::min(ms / shown_ms, 1.0)) * size.y;
  };
  const SimTime newest = history.recent().back().shown;
  const auto x_of = [&](SimTime time) {
    return at.x + size.x * static_cast<float>(1.0 - to_s(newest - time) / FrameHistory::kept_s);
  };
  draw.AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), IM_COL32(0, 0, 0, 255));
  for (const LiveFrame& frame : history.recent()) {
    if (frame.interval_ms <= 0.0) continue;
    const float right = x_of(frame.shown);
    const float left =
        std::max(right - size.x * static_cast<float>(frame.interval_ms * 1e-3 / FrameHistory::kept_s), at.x);
    const ImU32 colour = frame.missed > 0 ? IM_COL32(230, 60, 50, 255) : IM_COL32(90, 170, 90, 255);
    draw.AddRectFilled(
        ImVec2(left, y_of(frame.interval_ms)),
        ImVec2(right - left >= 4.0f ? right - 1.0f : std::max(right, left + 1.0f), at.y + size.y), colour);
  }
  for (const double periods : {1.0, 2.0, 3.0}) {
    const float y = y_of(periods * period_ms);
    draw.AddRectFilled(ImVec2(at.x, y), ImVec2(at.x + size.x, y + 1.0f), IM_COL32(200, 200, 200, 110));
  }
}

}  // namespace

void timeline_panel(Overlay& overlay, const OverlayFacts& facts, const FrameHistory& history,
                    const WindowRect& strip) {
  const bool open = overlay.begin_panel("timeline", strip);
  if (open) words(overlay, facts);
  if (open && !history.empty()) {
    std::int64_t missed = 0;
    for (const LiveFrame& frame : history.recent())
      missed += frame.missed;
    const double period_ms = 1e3 / facts.rate_hz;
    text(fmt::format(
        "intervals of the last {:g} s: lines at 1, 2 and 3 periods of {:.2f} ms; {} vsyncs missed (red)",
        FrameHistory::kept_s, period_ms, missed));
    const ImVec2 at = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
    if (room.y >= 8.0f) draw_bars(history, period_ms, at, room);
  }
  overlay.end_panel();
}

}  // namespace brace
