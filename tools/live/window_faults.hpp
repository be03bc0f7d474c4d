#pragma once

#include <functional>
#include <string>

namespace brace {

/// From now on an X error (a window that another program destroyed) is noted instead of ending the process on
/// the spot, and `last_act` is called when the X server is gone, before the process ends with
/// ExitCode::device_or_plugin_failed: Xlib goes on in neither case. Other window systems cause neither.
void note_window_faults(std::function<void()> last_act);

/// The first X error in Xlib's words; empty: none.
std::string window_fault();

}  // namespace brace
