#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/gpu/shader_compiler.hpp"
#include "runtime/host/stage_registry.hpp"

namespace brace {

/// The chosen stages as the kernels include them. `resolve` answers
///   stage/parameters.glsl  the parameters of all stages as specialisation constants FAMILY_PARAMETER
///                          (float, int or bool; a choice is an int) and parameter_macros
///   stage/FAMILY.glsl      the chosen stage's snippet under its own path, so that compile errors name the
///                          author's file and line; an empty text for a stage that has none
/// and whatever lies beside the snippets. `constants` are the parameters' values.
struct StageGlsl {
  gpu::IncludeResolver resolve;
  std::vector<gpu::SpecConstant> constants;
};
StageGlsl stage_glsl(std::span<const PipelineStage* const> stages);

/// One line per parameter: `layout(constant_id = 64) const float cast_step_voxels = 5e-01;`.
std::string parameter_declarations(const StageInfo& stage);

/// What a snippet composes itself by, so that the kernel holds nothing else: a macro per choice that is made,
/// `#define BRACE_CAST_INTEGRATOR_LEFT`, and one per parameter that is off at 0 by default and is on,
/// `#define BRACE_CAST_TOLERANCE_ON`.
std::string parameter_macros(const PipelineStage& stage);

/// The values that go with parameter_declarations.
std::vector<gpu::SpecConstant> parameter_constants(const PipelineStage& stage);

}  // namespace brace
