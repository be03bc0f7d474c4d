#pragma once

#include <chrono>

#include "base/time.hpp"

namespace brace {

/// A clock that goes on by itself, beside which simulated time stands still until it is told.
class WallClock {
 public:
  virtual ~WallClock() = default;
  virtual SimTime now() const = 0;
  /// Returns at once if the time has passed.
  virtual void wait_until(SimTime time) = 0;
};

/// The host's steady clock; 0 is when it was made.
class HostClock final : public WallClock {
 public:
  SimTime now() const override;
  /// Sleeps, and for the last moment looks at the clock: a sleep alone ends a tenth of a millisecond late.
  void wait_until(SimTime time) override;

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace brace
