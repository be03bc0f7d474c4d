#pragma once

#include <cstdint>

#include "runtime/session/session.hpp"

namespace brace {

/// Which vsyncs of a run a session's selection names. `ends` is the first vsync with a picture, the middle
/// one and the last one.
class VsyncSelection {
 public:
  VsyncSelection(const Session::Output::Selection& selection, std::int64_t vsyncs)
      : selection_(selection), vsyncs_(vsyncs) {}

  bool any() const { return selection_.kind != Session::Output::Selection::Kind::none; }

  /// Ask in the order of vsyncs, once for each that shows a picture.
  bool names(std::int64_t vsync_index);

 private:
  Session::Output::Selection selection_;
  std::int64_t vsyncs_;
  bool first_seen_ = false;
};

}  // namespace brace
