#include "runtime/replay/vsync_selection.hpp"

#include <algorithm>

namespace brace {

bool VsyncSelection::names(std::int64_t vsync_index) {
  using Kind = Session::Output::Selection::Kind;
  switch (selection_.kind) {
    case Kind::none:
      return false;
    case Kind::every:
      return vsync_index % selection_.every == 0;
    case Kind::list:
      return std::binary_search(selection_.list.begin(), selection_.list.end(), vsync_index);
    case Kind::ends:
      break;
  }
  const bool first = !first_seen_;
  first_seen_ = true;
  return first || vsync_index == vsyncs_ / 2 || vsync_index == vsyncs_ - 1;
}

}  // namespace brace
