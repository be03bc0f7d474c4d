#pragma once

#include <span>
#include <vector>

namespace brace {

struct AtlasRect {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The levels' rectangles in one picture, without overlap.
struct Atlas {
  int width = 0, height = 0;
  std::vector<AtlasRect> levels;
};

/// Packs rectangles (x and y are ignored), not turned, into a rectangle as small as it finds: skylines of
/// every width that is a sum of some of theirs, in every order (up to 5 of them; else by falling area).
Atlas pack_atlas(std::span<const AtlasRect> levels);

/// What pack_atlas is measured against: the first rectangle, the others in one column beside it.
Atlas fixed_atlas(std::span<const AtlasRect> levels);

}  // namespace brace
