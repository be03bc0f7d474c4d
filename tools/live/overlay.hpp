#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/image.hpp"
#include "tools/live/draw_list.hpp"
#include "tools/live/window_picture.hpp"

struct ImGuiContext;

namespace brace {

/// Where widgets stand in the window, by name: for tests that click.
using WidgetPlaces = std::map<std::string, WindowRect>;

/// Dear ImGui without a device: what it draws is painted onto the window's picture. One at a time per
/// process.
class Overlay {
 public:
  Overlay();
  ~Overlay();
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  /// Starts a frame over a window of this size; panels (overlay_figures.hpp, …) come between this and end().
  /// `seconds` since the last one. What the mouse and keys do must be in ImGui::GetIO() by then.
  void begin(int width_px, int height_px, double seconds);
  /// Paints the frame's panels.
  void end(ImageRgba8& onto);

  /// Whether mouse and keys belong to a widget and not to the head.
  bool wants_mouse() const;
  bool wants_keys() const;

  const WidgetPlaces& places() const { return places_; }

  /// A panel that fills a part of the window; false where that is empty, and nothing must be put in then. To
  /// be ended by end_panel() in either case.
  bool begin_panel(const char* name, const WindowRect& rect);
  void end_panel();
  /// A part of a panel that folds; true while it is open.
  bool heading(const char* name, bool open_at_first = false);
  /// Remembers where the last widget stands, if it is in view.
  void note_place(const std::string& name);
  void note_place(const std::string& name, const WindowRect& rect) { places_[name] = rect; }

 private:
  ImGuiContext* context_;
  CoverageTexture font_;
  WidgetPlaces places_;
  bool in_panel_ = false;
};

/// "x y width height name" in window pixels, a line per widget.
std::string places_text(const WidgetPlaces& places);

}  // namespace brace
