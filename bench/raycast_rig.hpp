#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/raycast_scene.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/raycast/native_steps.hpp"
#include "runtime/raycast/volume_path.hpp"
#include "runtime/skip/skip_structure.hpp"

namespace brace {

// What the benchmarks of ray casting have in common: the scene's volume on a device, and a ray caster that is
// ready to cast it again.

/// The load average of the last minute; 0: not known.
double host_load();

/// CPU time of all threads of this process so far.
double process_cpu_ms();

/// cast/native; null where its plug-in was not found.
const StageInfo* find_native(const StageRegistry& registry);

/// The scene's volume on one data path.
struct SceneVolume {
  SceneVolume(const gpu::Device& device, const SceneBall& ball, const VolumePathChoice& path);
  /// Share of the voxels with this value or a lower one.
  double share_up_to(int value) const;

  SceneBall ball;
  VoxelScan scan;
  VolumeOnDevice volume;
  VoxelStatistics statistics;
};

/// Who casts.
struct RigRenderer {
  const SceneVolume& scene_volume;
  SkipKind skip = SkipKind::none;
  const StageInfo* native = nullptr;  // null: cast/dvr
  int threads = 0;                    // of cast/native; 0: all
};

/// One renderer with one eye of a scene, a case per transfer function. What it is made from must outlive it.
class RaycastRig {
 public:
  /// `data_folder`: share/brace.
  RaycastRig(const gpu::Device& device, const std::filesystem::path& data_folder, const RaycastScene& scene,
             const RigRenderer& renderer);

  /// Opening brace, cast and closing brace.
  EyeCastOutcome cast_frame(std::size_t transfer);
  /// The same once, for the work of the cast.
  WorkCounts count(std::size_t transfer);
  /// How long the cast alone takes, opening and closing brace left out.
  struct CastTime {
    double ms = 0;      // device time of kernels, host time of a native stage
    double cpu_ms = 0;  // of all threads; 0 where the work is not done on the CPU
  };
  CastTime time_cast(std::size_t transfer);
  /// cast/native alone on part of the rays, which must have been opened by one of the above.
  struct Part {
    WorkCounts counted;
    double ms = 0;
  };
  Part cast_part(std::size_t transfer, const CastArea& area);

 private:
  struct Case {
    TransferTable table;
    TransferOnDevice transfer;
    EyeTarget target;
    std::unique_ptr<SkipStructure> skip;
  };

  Case prepare(const RigRenderer& renderer, const TransferFunction& function);
  void activate(const RigRenderer& renderer);
  CastPipeline::Resources resources(const Case& one) const;
  EyeCast eye(const CastPipeline::Resources& resources) const;

  const gpu::Device& device_;
  const RaycastScene& scene_;
  const VolumeOnDevice& volume_;
  CastPipeline pipeline_;
  RayBuffers rays_;
  gpu::CommandList commands_;
  SkipKernels skip_kernels_;
  std::vector<Case> cases_;
  std::unique_ptr<StageActivation> activation_;
  NativeStage native_;
  HostRays host_rays_;
};

}  // namespace brace
