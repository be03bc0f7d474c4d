#include "stages/control/control.hpp"
#include "stages/predict/predict.hpp"
#include "tools/command.hpp"

namespace brace {

StageRegistry make_stage_registry() {
  StageRegistry registry;
  registry.add_folder(data_folder() / "stages");
  registry.add(stages::predict_none, {});
  registry.add(stages::predict_constant_rate, {});
  registry.add(stages::predict_constant_acceleration, {});
  registry.add(stages::control_fixed, {});
  return registry;
}

}  // namespace brace
