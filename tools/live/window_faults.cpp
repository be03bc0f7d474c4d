#include "tools/live/window_faults.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>

#include <X11/Xlib.h>

#include "base/error.hpp"

namespace brace {

namespace {

// Xlib's handlers are functions without a context.
std::string noted_fault;
std::function<void()> last_act_of_all;

extern "C" int note_x_error(::Display* display, XErrorEvent* event) {
  std::array<char, 128> words{};
  XGetErrorText(display, event->error_code, words.data(), static_cast<int>(words.size()));
  if (noted_fault.empty()) noted_fault = words.data();
  return 0;
}

extern "C" int end_without_x_server(::Display*) {
  std::fputs("brace: live: the X server has gone, and the window with it\n", stderr);
  if (last_act_of_all) last_act_of_all();
  std::_Exit(static_cast<int>(ExitCode::device_or_plugin_failed));  // nothing can be freed of the window
}

}  // namespace

void note_window_faults(std::function<void()> last_act) {
  last_act_of_all = std::move(last_act);
  XSetErrorHandler(note_x_error);
  XSetIOErrorHandler(end_without_x_server);
}

std::string window_fault() {
  return noted_fault;
}

}  // namespace brace
