#pragma once

#include <string>

#include "tools/live/frame_history.hpp"
#include "tools/live/overlay.hpp"

namespace brace {

/// What the overlay says beside the frames' figures.
struct OverlayFacts {
  std::string session, device, head;  // head: what moves it
  int eye_width_px = 0, eye_height_px = 0;
  double rate_hz = 30.0;  // of the display's vsyncs
  bool recording = false;
  std::string fault;    // of the last reload or choice; "" if there is none
  std::string message;  // what was done last
};

/// What the session is, in the column.
void facts_panel(const OverlayFacts& facts, const FrameHistory& history);

/// Latency, age, work and the cost of every step, in the column.
void figures_panel(Overlay& overlay, const OverlayFacts& facts, const FrameHistory& history);

/// What went wrong or was done last, and the intervals of the last seconds as bars, missed vsyncs in red, in
/// the strip.
void timeline_panel(Overlay& overlay, const OverlayFacts& facts, const FrameHistory& history,
                    const WindowRect& strip);

}  // namespace brace
