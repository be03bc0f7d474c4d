#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/host/stage_registry.hpp"

namespace brace {

// Levels of rays/mab as items of a plan: "mab_level_0" is the finest.

/// "mab_level_0" …, as many as rays/mab can have.
const std::vector<std::string>& mab_level_items();

/// 2 of "mab_level_2"; none for other items.
std::optional<int> mab_level_of(const std::string& item);

/// Rays per pixel and axis of the levels that a rays stage asks for, finest first; none of another than
/// rays/mab.
std::vector<double> mab_scales(const PipelineStage& rays);

/// Takes levels out of rays/mab's parameters: what a level covered goes to the next coarser one, of the
/// coarsest to the next finer. Levels that are not there are no matter. Throws input_error if none is left.
void take_out_mab_levels(PipelineStage& rays, const std::vector<std::string>& items);

}  // namespace brace
