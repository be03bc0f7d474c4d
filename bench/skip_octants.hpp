#pragma once

#include <vector>

#include "bench/skip.hpp"

namespace brace::bench {

/// Whether a distance per octant of directions would pay: leaps of random rays through the blocks of the
/// scenes, counted, with the distance in all directions and with one per octant, which is never smaller. No
/// device is involved.
std::vector<SkipOctantRow> count_octants(const SkipBenchOptions& options);

}  // namespace brace::bench
