#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/error.hpp"
#include "base/time.hpp"

namespace brace {

/// Something that happens at a simulated time. `Kind` is the user's enum; `data` is for the user (a vsync
/// index, a frame).
template <typename Kind>
struct Event {
  SimTime time;
  std::uint64_t sequence = 0;  // insertion order, breaks ties
  Kind kind{};
  std::int64_t data = 0;
};

/// A discrete-event timeline: events come out ordered by (time, insertion order), and only taking one moves
/// simulated time, or being told what another clock says. A late event leaves now() where it is. The user
/// switches over the kind. Memory is reserved once; it grows only if more events wait at the same time than
/// were reserved for.
template <typename Kind>
class EventQueue {
 public:
  explicit EventQueue(std::size_t capacity = 64) { heap_.reserve(capacity); }

  SimTime now() const { return now_; }
  bool empty() const { return heap_.empty(); }
  std::size_t size() const { return heap_.size(); }
  std::uint64_t processed() const { return processed_; }

  /// An event never lies before the one taken last: that would be a programming error.
  void push(SimTime time, Kind kind, std::int64_t data = 0) {
    BRACE_CHECK(time >= last_);
    heap_.push_back({time, next_sequence_++, kind, data});
    std::push_heap(heap_.begin(), heap_.end(), later);
  }

  /// Removes the earliest event and moves now() to its time. The queue must not be empty.
  Event<Kind> pop() {
    BRACE_CHECK(!heap_.empty());
    std::pop_heap(heap_.begin(), heap_.end(), later);
    const Event<Kind> event = heap_.back();
    heap_.pop_back();
    last_ = event.time;
    catch_up(event.time);
    ++processed_;
    return event;
  }

  /// Moves now() on without an event: the clock beside it has gone on meanwhile.
  void catch_up(SimTime time) { now_ = std::max(now_, time); }

 private:
  static bool later(const Event<Kind>& a, const Event<Kind>& b) {
    return a.time != b.time ? a.time > b.time : a.sequence > b.sequence;
  }

  std::vector<Event<Kind>> heap_;
  SimTime now_ = SimTime::min(), last_ = SimTime::min();
  std::uint64_t next_sequence_ = 0;
  std::uint64_t processed_ = 0;
};

}  // namespace brace
