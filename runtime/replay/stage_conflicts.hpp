#pragma once

#include "runtime/session/session.hpp"

namespace brace {

/// Whether the session's stage of a family is a shared library.
bool is_native(const Session& session, const char* family);

/// Throws input_error for stages that cannot give layers to the session's warp.
void require_layers(const Session& session);

/// Throws input_error for stages that schedule/chunked cannot cast in cells.
void require_cells(const Session& session);

/// Throws input_error for stages whose cells cannot be cast or shown one by one, where the session's schedule
/// or its clock asks for that.
void require_cell_poses(const Session& session);

/// Throws input_error for stages whose rays cannot begin where skip/occlusion says.
void require_occlusion(const Session& session);

/// Throws input_error for stages that do not work with coarser levels of the volume.
void require_levels(const Session& session);

/// All of these as far as they matter to the session: throws input_error if its stages do not work together.
void require_agreement(const Session& session);

}  // namespace brace
