#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/raycast/cast_pipeline.hpp"
#include "tests/reference/raycaster.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"

namespace brace {

/// A volume in memory as a source.
class MemorySource final : public VolumeSource {
 public:
  explicit MemorySource(const Volume& volume) : VolumeSource(volume.info), volume_(volume) {}

 private:
  void produce(std::span<std::byte> out, int z_begin, int z_count) override;
  const Volume& volume_;
};

/// A float volume of the given size; value(x, y, z) gives the voxels.
template <typename Value>
Volume float_volume(std::array<int, 3> dims, const Value& value) {
  Volume volume;
  volume.info.dims = dims;
  volume.info.type = VoxelType::float32;
  volume.info.source = "made by the test";
  std::vector<float> voxels;
  for (int z = 0; z < dims[2]; ++z)
    for (int y = 0; y < dims[1]; ++y)
      for (int x = 0; x < dims[0]; ++x)
        voxels.push_back(static_cast<float>(value(x, y, z)));
  const auto bytes = std::as_bytes(std::span(voxels));
  volume.voxels.assign(bytes.begin(), bytes.end());
  return volume;
}

Volume load(const std::string& path_or_generator);

/// A function over fractions of the range, baked for a volume of that range.
TransferTable table_over(const Volume& volume, ValueRange range, std::vector<TransferPoint> points);

/// Smooth: transparent below 0.2 of the range, then more and more opaque and changing colour.
TransferTable smooth_table(const Volume& volume, ValueRange range);

/// An eye at `position` (in edges of a volume of 1 m at the origin) looking at the centre.
EyeView look_at_centre(const glm::dvec3& position, int width_px = 64, int height_px = 64,
                       double fov_rad = 0.7);

struct CastSettings {
  double step_voxels = 0.5;
  double termination = 0.99;
  bool phong = false;
  bool counters = true;
  std::string integrator = "midpoint-exponential";
  std::string preintegration = "table";
  double tolerance = 0.0;
  double step_voxels_min = 0.0625, step_voxels_max = 1.0;
  int light_samples = -1;  // of random_lights; -1: other shading
  bool shadow_ao = false;
  auto operator<=>(const CastSettings&) const = default;
};

reference::Options reference_options(const CastSettings& settings);

/// What came out of the kernels.
struct Shot {
  std::vector<glm::vec4> colours;
  std::vector<float> depths_m;
  std::vector<std::uint32_t> image;
  std::vector<float> image_depths_m;
  std::vector<glm::vec4> entries, directions;
  WorkCounts work;
};

struct Difference {
  double max = 0.0;
  double rms = 0.0;
};
Difference difference(const std::vector<glm::vec4>& colours, const reference::Picture& picture);
Difference difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b);

/// 0 <= C <= A <= 1 and no NaN, anywhere.
bool is_bounded(const std::vector<glm::vec4>& colours);

class RaycastTest : public gpu::GpuTest {
 protected:
  static CastParts parts(const CastSettings& settings);
  static gpu::CompileOptions compile_options();

  /// The pipeline for a volume's access and settings; kept for the test.
  const CastPipeline& pipeline(const VolumeOnDevice& volume, const CastSettings& settings);

  Shot shoot(const VolumeOnDevice& volume, const TransferTable& table, const EyeView& eye,
             const VolumePlacement& placement, const CastSettings& settings = {});
  Shot shoot(const Volume& volume, const TransferTable& table, const EyeView& eye,
             const VolumePlacement& placement, const CastSettings& settings = {},
             VolumePath path = VolumePath::automatic);
  static VolumeOnDevice on_device(const Volume& volume, VolumePath path = VolumePath::automatic);

  /// Casts rays that the test wrote itself: entry and length, direction and level.
  std::vector<glm::vec4> cast_rays(const VolumeOnDevice& volume, const TransferTable& table,
                                   const std::vector<glm::vec4>& entries,
                                   const std::vector<glm::vec4>& directions, const CastSettings& settings);

 private:
  struct Key {
    std::string access;
    CastSettings settings;
    auto operator<=>(const Key&) const = default;
  };
  std::map<Key, CastPipeline> pipelines_;
};

/// Folder with the real volumes, or an empty path.
std::filesystem::path shared_volumes();
std::filesystem::path preset_folder();

}  // namespace brace
