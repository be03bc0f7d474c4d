#include "tools/interrupt.hpp"

#include <csignal>
#include <cstdlib>

#include "base/error.hpp"

namespace brace {

namespace {

volatile std::sig_atomic_t noted_signal = 0;  // a signal handler can reach nothing else

extern "C" void note_signal(int number) {
  noted_signal = number;
}

}  // namespace

void note_interrupts() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // nohup, or a shell's background job
    action.sa_handler = note_signal;
    action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    ::sigemptyset(&action.sa_mask);
    ::sigaction(number, &action, nullptr);
  }
}

bool interrupted() {
  return noted_signal != 0;
}

void end_by_noted_signal() {
  const int number = noted_signal;
  BRACE_CHECK(number != 0);
  std::signal(number, SIG_DFL);
  std::raise(number);
  std::_Exit(128 + number);  // the signal was blocked
}

}  // namespace brace
