#pragma once

#include <functional>

namespace brace {

/// What holding a rate comes to.
struct LiveScale {
  double scale = 0.0;                     // resolution_scale
  double eyes_ms = 0.0, window_ms = 0.0;  // host time of a picture at that scale, in all
  bool holds = false;                     // these two fit into a period, with little to spare
};

/// The largest scale, at most `asked`, at which both eyes and a window's picture fit into a period of the
/// rate. Time falls slower than the pixels where a few of them take most of it, so `eyes_ms_at` is asked anew
/// at each step down. A window that takes all of a period leaves the smallest scale.
LiveScale choose_scale(double asked, double rate_hz, double window_ms,
                       const std::function<double(double scale)>& eyes_ms_at);

}  // namespace brace
