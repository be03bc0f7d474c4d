#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

/// The tiles of a picture, in the order in which one thread of oneTBB takes them: parallel_for over a
/// blocked_range2d of whole tiles halves its longer edge until one tile is left.
std::vector<CastArea> split_tiles(int width_px, int height_px, int tile_px);

/// Time until the last of `threads` is done, in the unit of `costs`, where each thread that is free takes the
/// next tile (list scheduling). Work stealing keeps threads as busy, though not in this order: no thread
/// waits while there is a tile that none has begun. What taking a tile costs, and what threads take from each
/// other (caches, memory, clock), is left out. 0 without tiles.
double makespan(std::span<const double> costs, int threads);

/// Sum of the costs over the makespan: 1 ... threads. 1 where there is no work.
double speed_up(std::span<const double> costs, int threads);

}  // namespace brace
