#include "runtime/plan/cast_choice.hpp"

#include <algorithm>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "base/error.hpp"
#include "runtime/gpu/shader_compiler.hpp"
#include "runtime/replay/eye_rig.hpp"

namespace brace {

namespace {

constexpr int frames_timed = 5;
constexpr double clearly_faster = 1.1;  // less is noise

const StageInfo* find_cast(const StageRegistry& registry, const std::string& name) {
  for (const StageInfo& stage : registry.stages())
    if (stage.family == "cast" && stage.name == name) return &stage;
  return nullptr;
}

/// What their speed depends on beside the device: dvr's snippets, native's library and its threads.
std::string texts_of_casts(const StageRegistry& stages, const std::filesystem::path& data_folder) {
  std::string texts = fmt::format("{} host threads", std::thread::hardware_concurrency());
  if (const StageInfo* dvr = find_cast(stages, "dvr")) {
    const auto beside = gpu::directory_resolver({dvr->glsl_source.parent_path(), data_folder / "glsl"});
    texts += ", dvr " + gpu::kernel_key({gpu::read_glsl(dvr->glsl_source), beside, {}, {}});
  }
  if (const StageInfo* native = find_cast(stages, "native")) {
    std::error_code gone;
    const auto written = std::filesystem::last_write_time(native->origin, gone).time_since_epoch();
    texts += fmt::format(", native {} {} bytes {}", native->version,
                         std::filesystem::file_size(native->origin, gone), written.count());
  }
  return texts;
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

CastChoice choose_cast(const gpu::Device& device, const StageRegistry& stages,
                       const std::filesystem::path& data_folder, gpu::Measurements& measurements) {
  gpu::Comparison casts{"raycaster", texts_of_casts(stages, data_folder), {}};
  for (const char* cast : {"dvr", "native"})
    if (find_cast(stages, cast) != nullptr) casts.rivals.emplace_back(cast);
  const gpu::Measurement& measured = measurements.get(device.info(), casts, [&] {
    std::vector<double> times_ms;
    for (const std::string& cast : casts.rivals)
      times_ms.push_back(shortest_frame_ms(device, stages, data_folder, cast));
    return times_ms;
  });
  CastChoice choice{"dvr", {}, measured.origin()};
  for (std::size_t i = 0; i < casts.rivals.size(); ++i)
    choice.times.push_back({casts.rivals[i], measured.times_ms[i]});
  const bool native_wins = device.info().limits.is_software && choice.times.size() == 2 &&
                           choice.times[1].frame_ms * clearly_faster < choice.times[0].frame_ms;
  if (native_wins) choice.cast = "native";
  return choice;
}

}  // namespace brace
