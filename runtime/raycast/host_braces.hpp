#pragma once

#include "base/time.hpp"
#include "runtime/raycast/cast_pipeline.hpp"

namespace brace {

// The braces of rays/full_rate on the host, for casts that execute there on a software device: what
// rays_main.comp and close_main.comp do, in SIMD lanes and without submissions. The device is idle meanwhile.

/// Whether the device maps all buffers of an eye, so that its braces may work on the host.
bool maps_braces(const CastPipeline::Resources& in);

/// Opens the rays of `area`, in cells of the ray grid, and returns how long that took.
SimDuration open_on_host(const CastPipeline::Resources& in, const CastArea& area);

/// Closes the pixels of `area`.
SimDuration close_on_host(const CastPipeline::Resources& in, const CastArea& area);

}  // namespace brace
