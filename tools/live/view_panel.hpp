#pragma once

#include <optional>

#include "tools/live/overlay.hpp"
#include "tools/live/view_colours.hpp"

namespace brace {

/// The switch between views and how to read the one that is shown, in the panel that is open; the view chosen
/// anew.
std::optional<ViewKind> view_panel(Overlay& overlay, ViewKind now, const ViewLegend& legend);

}  // namespace brace
