#include "runtime/replay/scene_shading.hpp"

#include <glm/geometric.hpp>

namespace brace {

SampledShading sampled_shading(const Session::Scene& scene, const VolumePlacement& placement,
                               double table_step_units) {
  SampledShading shading;
  if (scene.shading == "shadow_ao") shading.kind = SampledShading::Kind::shadow_ao;
  if (scene.shading == "random_lights") shading.kind = SampledShading::Kind::random_lights;
  shading.samples = scene.shading_samples;
  shading.step_units = scene.shading_step_voxels;
  shading.steps_of_table = scene.shading_step_voxels / table_step_units;
  const glm::dvec3 light(scene.light[0], scene.light[1], scene.light[2]);
  shading.light = glm::conjugate(placement.world_from_volume.orientation) * glm::normalize(light);
  return shading;
}

}  // namespace brace
