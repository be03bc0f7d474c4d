#include "bench/cast_choice.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.hpp"
#include "bench/eye_rig.hpp"

namespace brace {

namespace {

constexpr int frames_timed = 5;

bool is_there(const StageRegistry& stages, const std::string& name) {
  return std::any_of(stages.stages().begin(), stages.stages().end(),
                     [&](const StageInfo& stage) { return stage.family == "cast" && stage.name == name; });
}

double shortest_frame_ms(const gpu::Device& device, const StageRegistry& stages,
                         const std::filesystem::path& data_folder, const std::string& cast) {
  const std::string text = fmt::format(
      "device.profile = 'htc-vive'\ndevice.resolution_scale = 0.2\ntrace.neck = {{ motion = 'still' }}\n"
      "pipeline.cast = '{}'\npipeline.skip = 'distance_map'\n[scene]\nvolume = 'generator:nested_shells:96'\n"
      "transfer_function = 'tf3'\nsize_m = 0.8\nposition = 'front:0.9'\n",
      cast);
  EyeRig rig(device, data_folder, parse_session(text, "doctor", ".", {}, stages));
  rig.render();
  double shortest_s = 1e9;
  for (int i = 0; i < frames_timed; ++i)
    shortest_s = std::min(shortest_s, to_s(rig.render().device_time));
  return 1e3 * shortest_s;
}

}  // namespace

std::vector<CastTime> time_casts(const gpu::Device& device, const StageRegistry& stages,
                                 const std::filesystem::path& data_folder) {
  std::vector<CastTime> times;
  for (const char* cast : {"dvr", "native"})
    if (is_there(stages, cast)) times.push_back({cast, shortest_frame_ms(device, stages, data_folder, cast)});
  return times;
}

std::string recommended_cast(const gpu::Device& device, const std::vector<CastTime>& times) {
  if (!device.info().limits.is_software || times.empty()) return "dvr";
  return std::min_element(times.begin(), times.end(),
                          [](const CastTime& a, const CastTime& b) { return a.frame_ms < b.frame_ms; })
      ->cast;
}

}  // namespace brace
