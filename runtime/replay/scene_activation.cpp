#include "runtime/replay/scene_activation.hpp"

#include "base/error.hpp"
#include "runtime/raycast/native_steps.hpp"
#include "runtime/replay/scene_shading.hpp"

namespace brace {

ActivationInput scene_activation(const gpu::Device& device, const Session& session, const Headset& headset,
                                 const SceneOnDevice& scene, const VolumePlacement& placement) {
  ActivationInput input = activation_input(device, scene.volume, placement, scene.table, scene.step_units,
                                           headset.eye.width_px, headset.eye.height_px);
  if (session.scene.shading == "phong") input.shading = BRACE_SHADING_PHONG;
  if (session.scene.shading == "shadow_ao") input.shading = BRACE_SHADING_SHADOW_AO;
  if (session.scene.shading == "random_lights") input.shading = BRACE_SHADING_RANDOM_LIGHTS;
  const SampledShading sampled = sampled_shading(session.scene, placement, scene.step_units);
  input.shading_samples = static_cast<std::uint32_t>(sampled.samples);
  input.shading_step_units = sampled.step_units;
  input.shading_light = sampled.light;
  OpenOptions as_on_device;
  if (session.scene.nan == "empty") as_on_device.non_finite = NonFinitePolicy::treat_as_empty;
  input.open_volume = [as_on_device, source = session.scene.volume] {
    return open_volume(source, as_on_device);
  };
  return input;
}

ActiveStage::ActiveStage(const PipelineStage& stage, const ActivationInput& input)
    : activation_(input), stage_(stage) {
  try {
    stage_.activate(activation_.get());
  } catch (const Error&) {
    activation_.rethrow_read_error();
    throw;
  }
}

}  // namespace brace
