#include "bench/raycast_rivals.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/error.hpp"

namespace brace {

namespace {

using nlohmann::json;

/// A temporary folder, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "brace-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw device_error("{}: cannot make a temporary folder", name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

json vector_of(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// VTK's points lie at whole numbers, our voxel centres at i + 0.5; the scene's spacing is 1 in both.
json describe(const RaycastBenchOptions& options, const RaycastScene& scene, const VolumeInfo& volume,
              const std::string& voxels) {
  const glm::dquat volume_from_eye =
      glm::conjugate(scene.placement.world_from_volume.orientation) * scene.eye.world_from_eye.orientation;
  json transfers = json::array();
  for (const auto& transfer : scene.transfers) {
    json points = json::array();
    for (const TransferPoint& point : transfer.function.points) {
      const TransferSample& s = point.sample;
      points.push_back({point.value, s.r, s.g, s.b, s.kappa});
    }
    transfers.push_back({{"name", transfer.name}, {"points", std::move(points)}});
  }
  return {
      {"voxels", voxels},
      {"edge", volume.dims[0]},
      {"step_voxels", scene.step_voxels},
      {"eye", vector_of(voxel_from_world(volume, scene.placement, scene.eye.world_from_eye.position) - 0.5)},
      {"forward", vector_of(volume_from_eye * glm::dvec3(0, 0, -1))},
      {"up", vector_of(volume_from_eye * glm::dvec3(0, 1, 0))},
      {"fov_deg", 2.0 * std::atan(scene.eye.tan_top) * 180.0 / std::numbers::pi},
      {"width_px", scene.eye.width_px},
      {"height_px", scene.eye.height_px},
      {"repetitions", options.repetitions},
      {"transfers", std::move(transfers)}};
}

std::filesystem::path write_scene(const RaycastBenchOptions& options, const RaycastScene& scene,
                                  const std::filesystem::path& folder) {
  const auto source = open_scene_volume();
  const Volume volume = load_volume(*source);
  const std::filesystem::path voxels = folder / "voxels.raw";
  std::ofstream(voxels, std::ios::binary)
      .write(reinterpret_cast<const char*>(volume.voxels.data()),
             static_cast<std::streamsize>(volume.voxels.size()));
  const std::filesystem::path file = folder / "scene.json";
  std::ofstream(file) << describe(options, scene, volume.info, voxels.string()).dump(2);
  return file;
}

/// Adds what one run of the script printed.
void read_line(const std::string& line, std::vector<RaycastBenchCase>& cases,
               std::vector<std::string>& notes) {
  const json found = json::parse(line, nullptr, false);
  if (found.is_discarded() || !found.is_object()) return;  // a warning of VTK's
  if (found.contains("error")) {
    notes.push_back(found["error"].get<std::string>());
    return;
  }
  RaycastBenchCase one;
  one.is_rival = true;
  one.renderer = found["renderer"].get<std::string>();
  one.transfer = found["transfer"].get<std::string>();
  one.frame_ms_median = found["median_ms"].get<double>();
  one.frame_ms_min = found["min_ms"].get<double>();
  one.cpu_ms_min = found["cpu_min_ms"].get<double>();
  cases.push_back(std::move(one));
}

void run_script(const std::string& command, std::vector<RaycastBenchCase>& cases,
                std::vector<std::string>& notes) {
  const std::size_t known = cases.size() + notes.size();
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    notes.push_back("VTK was not measured: no process could be started");
    return;
  }
  std::string line;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    if (c != '\n') {
      line.push_back(static_cast<char>(c));
      continue;
    }
    read_line(line, cases, notes);
    line.clear();
  }
  const int status = pclose(pipe);
  if (status != 0 || cases.size() + notes.size() == known) {
    notes.push_back(fmt::format("VTK was not measured: '{}' ended with {}; apt install python3-vtk9 xvfb",
                                command, status));
  }
}

}  // namespace

void measure_raycast_rivals(const RaycastBenchOptions& options, const RaycastScene& scene,
                            std::vector<RaycastBenchCase>& cases, std::vector<std::string>& notes) {
  const std::filesystem::path script = options.data_folder / "bench" / "rivals" / "vtk_volume.py";
  const std::filesystem::path python = "/usr/bin/python3";
  if (!std::filesystem::exists(python)) {
    notes.push_back("VTK was not measured: /usr/bin/python3 is not there; apt install python3-vtk9 xvfb");
    return;
  }
  const ScratchFolder folder;
  const std::string scene_file = write_scene(options, scene, folder.path()).string();
  const auto script_on = [&](const char* before, const char* kind) {
    return fmt::format("{} {} '{}' '{}' {} 2>/dev/null", before, python.string(), script.string(), scene_file,
                       kind);
  };
  if (std::filesystem::exists("/usr/bin/xvfb-run")) {
    run_script(script_on("LIBGL_ALWAYS_SOFTWARE=1 GALLIUM_DRIVER=llvmpipe xvfb-run -a", "gpu"), cases, notes);
    run_script(script_on("xvfb-run -a", "cpu"), cases, notes);
  } else {
    notes.push_back("VTK was not measured: it needs a virtual X server; apt install python3-vtk9 xvfb");
  }
}

}  // namespace brace
