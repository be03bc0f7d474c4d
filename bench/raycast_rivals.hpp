#pragma once

#include <string>
#include <vector>

#include "bench/raycast.hpp"
#include "bench/raycast_scene.hpp"

namespace brace {

/// Writes the scene to a temporary folder and lets bench/rivals/vtk_volume.py render it with VTK's GPU mapper
/// (on Mesa's software OpenGL, in a virtual X server) and its fixed-point CPU mapper with one and two
/// threads. What is not installed or fails becomes a note.
void measure_raycast_rivals(const RaycastBenchOptions& options, const RaycastScene& scene,
                            std::vector<RaycastBenchCase>& cases, std::vector<std::string>& notes);

}  // namespace brace
