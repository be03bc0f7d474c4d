#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/gpu/measurements.hpp"
#include "runtime/raycast/cast_pipeline.hpp"
#include "runtime/skip/skip_structure.hpp"
#include "runtime/volume/transfer_function.hpp"

namespace brace {

/// How cast/dvr is set for a case; the rest are its defaults.
struct CastRule {
  std::string integrator = "midpoint-exponential";
  std::string preintegration = "table";
  double step_voxels = 0.5;
  double tolerance = 0.0;
  double termination = 1.0;
  auto operator<=>(const CastRule&) const = default;
  std::string name() const;  // "pre-integrated (2D table)"
};

/// The integrators, the two forms of pre-integration each.
std::vector<CastRule> all_cast_rules();

/// A ray in voxel coordinates: entry and length in units; direction in voxels per unit.
struct CastRay {
  glm::vec4 entry;
  glm::vec4 direction;
};

/// Rays through a volume.
struct CastCase {
  const Volume* volume = nullptr;  // compared by address: it stays as long as the caster
  TransferTable table;
  std::vector<CastRay> rays;
  CastRule rule;
  SkipKind skip = SkipKind::none;
  Occupancy occupancy = Occupancy::cell;
};

struct CastResult {
  std::vector<glm::vec4> colours;  // premultiplied
  std::vector<float> depths;       // metres
  WorkCounts work;
};

/// Runs cases on a device with the kernels of the data folder.
class Caster {
 public:
  Caster(const gpu::Device& device, std::filesystem::path data_folder);
  ~Caster();

  CastResult operator()(const CastCase& wanted);
  /// Gives back the device memory of a volume that goes.
  void forget(const Volume& volume);

 private:
  struct Loaded;
  Loaded& loaded(const Volume& volume);
  const CastPipeline& pipeline(const CastCase& wanted, const VolumeOnDevice& volume);

  const gpu::Device& device_;
  std::filesystem::path data_folder_;
  gpu::Measurements measurements_;
  std::unique_ptr<SkipKernels> skip_kernels_;
  std::map<const Volume*, std::unique_ptr<Loaded>> volumes_;
  std::map<std::string, CastPipeline> pipelines_;
};

/// A volume of floats; value(x, y, z) gives the voxels.
template <typename Value>
Volume make_volume(std::array<int, 3> dims, const Value& value);

/// A table over [0, length] of kappa(value) and a grey level c(value).
template <typename Kappa, typename Colour>
TransferTable make_table(double length, int entries, const Kappa& kappa, const Colour& colour) {
  TransferTable table;
  table.range = {0.0, length};
  for (int i = 0; i < entries; ++i) {
    const double v = length * i / (entries - 1);
    table.entries.push_back({colour(v), 0.0, 0.0, kappa(v)});
  }
  return table;
}

template <typename Value>
Volume make_volume(std::array<int, 3> dims, const Value& value) {
  Volume volume;
  volume.info.dims = dims;
  volume.info.type = VoxelType::float32;
  volume.info.source = "made for the verification";
  std::vector<float> voxels;
  for (int z = 0; z < dims[2]; ++z)
    for (int y = 0; y < dims[1]; ++y)
      for (int x = 0; x < dims[0]; ++x)
        voxels.push_back(static_cast<float>(value(x, y, z)));
  const auto bytes = std::as_bytes(std::span(voxels));
  volume.voxels.assign(bytes.begin(), bytes.end());
  return volume;
}

}  // namespace brace
