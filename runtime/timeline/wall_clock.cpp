#include "runtime/timeline/wall_clock.hpp"

#include <thread>

namespace brace {

SimTime HostClock::now() const {
  return SimTime(std::chrono::steady_clock::now() - begin_);
}

void HostClock::wait_until(SimTime time) {
  const auto until = begin_ + time.time_since_epoch();
  std::this_thread::sleep_until(until - std::chrono::microseconds(200));
  while (std::chrono::steady_clock::now() < until) {
  }
}

}  // namespace brace
