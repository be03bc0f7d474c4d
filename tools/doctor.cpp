#include <thread>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/error.hpp"
#include "runtime/gpu/device.hpp"
#include "runtime/gpu/shader_compiler.hpp"
#include "runtime/plan/cast_choice.hpp"
#include "runtime/raycast/path_choice.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

struct Check {
  std::string name;
  bool ok = false;
  std::string found;
};

Check check_data_folder() {
  try {
    return {"data folder", true, data_folder().string()};
  } catch (const Error& e) {
    return {"data folder", false, e.what()};
  }
}

Check check_stages() {
  try {
    return {"stages", true, fmt::format("{} found", make_stages({}).registry.stages().size())};
  } catch (const Error& e) {
    return {"stages", false, e.what()};
  }
}

std::vector<Check> check_vulkan(const std::string& gpu) {
  std::vector<Check> checks;
  try {
    for (const gpu::DeviceInfo& device : gpu::list_devices()) {
      const bool usable = device.missing.empty();
      checks.push_back(
          {fmt::format("Vulkan device {}", device.index), usable,
           fmt::format("{} ({}, {}, Vulkan {}){}", device.name, gpu::to_string(device.type), device.driver,
                       device.api_version_text, usable ? "" : "; lacks " + device.missing)});
    }
    const gpu::Device device(gpu::DeviceOptions{.select = gpu});
    const gpu::DeviceLimits& limits = device.limits();
    checks.push_back({"a run uses", true, device.info().name});
    checks.push_back({"limits", true,
                      fmt::format("allocation {} MiB, storage buffer {} MiB, texel buffer {} Mi texels",
                                  limits.allocation_bytes_max >> 20, limits.storage_buffer_bytes_max >> 20,
                                  limits.texel_buffer_texels_max >> 20)});
  } catch (const Error& e) {
    if (e.exit_code() == ExitCode::bad_input) throw;
    checks.push_back({"Vulkan", false, e.what()});
  }
  return checks;
}

/// Which raycaster is the one to name in pipeline.cast here: measured, for without a GPU it is not plain.
Check check_casts(const std::string& gpu, gpu::Measurements& measurements) {
  try {
    const gpu::Device device(gpu::DeviceOptions{.select = gpu});
    const CastChoice choice = choose_cast(device, make_stages({}).registry, data_folder(), measurements);
    std::string found = fmt::format("pipeline.cast = \"{}\" on {}", choice.cast,
                                    device.info().limits.is_software ? "this software device" : "this GPU");
    for (const CastTime& time : choice.times)
      found += fmt::format("; {} {:.1f} ms", time.cast, time.frame_ms);
    return {"raycaster", true, found + fmt::format(" ({})", choice.origin)};
  } catch (const Error& e) {
    return {"raycaster", false, e.what()};
  }
}

/// How cast/dvr reads volumes that fit either way on each device.
std::vector<Check> check_data_paths(gpu::Measurements& measurements) {
  std::vector<Check> checks;
  try {
    for (const gpu::DeviceInfo& info : gpu::list_devices()) {
      if (!info.missing.empty()) continue;
      const gpu::Device device(gpu::DeviceOptions{.select = std::to_string(info.index)});
      for (const auto& [type, name] : {std::pair(VoxelType::uint8, "8 bit"),
                                       {VoxelType::uint16, "16 bit"},
                                       {VoxelType::float32, "float"}}) {
        VolumeInfo volume;
        volume.dims = {64, 64, 64};
        volume.type = type;
        const VolumePathChoice choice =
            choose_volume_path(device, volume, VolumePath::automatic, data_folder(), measurements);
        checks.push_back({fmt::format("data path {}, {}", info.index, name), true,
                          choice.figures.empty() ? choice.reason : choice.figures});
      }
    }
  } catch (const Error& e) {
    checks.push_back({"data path", false, e.what()});
  }
  return checks;
}

/// A folder that cannot be written is no fault: what it would keep is made again.
Check check_cache(const std::string& name, const std::filesystem::path& folder) {
  if (folder.empty()) return {name, true, "off: neither XDG_CACHE_HOME nor HOME is set"};
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const bool writable = !error && ::access(folder.c_str(), W_OK) == 0;
  return {name, writable,
          writable ? folder.string() : folder.string() + " cannot be written: nothing is kept"};
}

}  // namespace

int doctor_command(const DoctorCommand& command) {
  std::vector<Check> checks = {check_data_folder(), check_stages()};
  for (Check& check : check_vulkan(command.gpu))
    checks.push_back(std::move(check));
  gpu::Measurements measurements(gpu::default_measurement_folder(), command.measure_again
                                                                        ? gpu::Measurements::Use::anew
                                                                        : gpu::Measurements::Use::kept);
  for (Check& check : check_data_paths(measurements))
    checks.push_back(std::move(check));
  checks.push_back(check_casts(command.gpu, measurements));
  checks.push_back(check_cache("kernel cache", gpu::default_cache_folder()));
  checks.push_back(check_cache("measurements", gpu::default_measurement_folder()));
  checks.push_back({"host threads", true, std::to_string(std::thread::hardware_concurrency())});

  bool ok = true;
  nlohmann::ordered_json json = {{"version", BRACE_VERSION}, {"checks", nlohmann::ordered_json::array()}};
  for (const Check& check : checks) {
    // A device that is not usable is no fault while another one is.
    const bool listed_only = check.name.rfind("Vulkan device", 0) == 0 || check.name == "kernel cache" ||
                             check.name == "measurements";
    ok = ok && (check.ok || listed_only);
    json["checks"].push_back({{"name", check.name}, {"ok", check.ok}, {"found", check.found}});
    if (!command.json)
      fmt::print("{:<5} {:<20} {}\n", check.ok ? "ok" : (listed_only ? "-" : "FAIL"), check.name,
                 check.found);
  }
  json["ok"] = ok;
  if (command.json) fmt::print("{}\n", json.dump(2));
  return static_cast<int>(ok ? ExitCode::done : ExitCode::device_or_plugin_failed);
}

}  // namespace brace
