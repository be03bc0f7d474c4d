#pragma once

#include <string>
#include <utility>
#include <vector>

#include "runtime/host/stage_registry.hpp"

namespace brace {

/// What one cast stage is told, as settings of another: parameters by name, those at their default left out.
/// Throws input_error for one that the other has not.
std::vector<std::pair<std::string, double>> settings_for(const PipelineStage& told, const StageInfo& other);

}  // namespace brace
