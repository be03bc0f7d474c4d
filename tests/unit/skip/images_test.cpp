#include <algorithm>
#include <cstdlib>
#include <map>

#include "runtime/host/stage_glsl.hpp"
#include "skip/skip_fixture.hpp"

namespace brace {
namespace {

constexpr int grid_edge = 8;  // rays across and down
constexpr int ray_count = grid_edge * grid_edge;

/// What the cast kernel writes for each ray.
struct Picture {
  std::vector<std::array<std::uint32_t, 4>> colours;  // bits of the floats
  std::vector<std::uint32_t> depths;
  bool operator==(const Picture&) const = default;
};

struct RayInput {
  std::array<float, 4> entry, direction;
};

/// Rays that graze faces, run along axes, start inside and on borders between blocks, or anyhow.
std::vector<RayInput> random_rays(Random& random, const VolumeInfo& info) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<RayInput> rays;
  const double smallest = voxel_length(info);
  while (rays.size() < ray_count) {
    const int kind = random_int(random, 0, 5);
    std::array<double, 3> at{}, direction{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = unit(random) * info.dims[axis];
      direction[axis] = unit(random) - 0.5;
      if (kind == 1) at[axis] = std::floor(at[axis]);                           // on borders
      if (kind == 2 && random_int(random, 0, 1) == 0) direction[axis] = 0.0;    // axis-parallel
      if (kind == 3 && random_int(random, 0, 1) == 0) direction[axis] *= 1e-6;  // grazing
      if (kind == 4 && random_int(random, 0, 1) == 0) at[axis] = random_int(random, 0, 1) * info.dims[axis];
    }
    double length = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      length += direction[axis] * direction[axis];
    length = std::sqrt(length);
    if (length < 1e-9) continue;
    double back = kind == 5 ? 0.0 : 1e9, forth = 1e9;  // units to the box; kind 5 starts inside
    for (std::size_t axis = 0; axis < 3; ++axis) {
      direction[axis] = direction[axis] / length * (smallest / info.spacing[axis]);
      if (direction[axis] == 0.0) continue;
      const double low = (0.0 - at[axis]) / direction[axis],
                   high = (info.dims[axis] - at[axis]) / direction[axis];
      back = std::min(back, -std::min(low, high));
      forth = std::min(forth, std::max(low, high));
    }
    RayInput ray{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray.entry[axis] =
          static_cast<float>(std::clamp(at[axis] - back * direction[axis], 0.0, 1.0 * info.dims[axis]));
      ray.direction[axis] = static_cast<float>(direction[axis]);
    }
    ray.entry[3] = static_cast<float>(back + forth);
    rays.push_back(ray);
  }
  return rays;
}

class SkipImages : public SkipTest {
 protected:
  static void TearDownTestSuite() {
    pipelines_.clear();
    SkipTest::TearDownTestSuite();
  }

  void SetUp() override {
    SkipTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    target_ = EyeTarget(device(), grid_edge, grid_edge);
    rays_ = RayBuffers(device(), grid_edge, grid_edge);
  }

  const CastPipeline& pipeline(SkipKind kind, const VolumeOnDevice& volume, double step) {
    std::string key = fmt::format("{} {} {}", to_string(kind), static_cast<int>(volume.path()), step);
    if (volume.path() == VolumePath::packed) key += volume.defines().front().first;
    const auto found = pipelines_.find(key);
    if (found != pipelines_.end()) return found->second;
    const auto stage = [](const std::string& id) {
      PipelineStage chosen{read_stage_manifest(source_folder() / "stages" / id / "stage.toml"), {}};
      for (const StageParameter& parameter : chosen.stage.parameters)
        chosen.values.push_back(parameter.default_value);
      return chosen;
    };
    const PipelineStage rays = stage("rays/full_rate"), skip = stage(std::string("skip/") + to_string(kind));
    PipelineStage cast = stage("cast/dvr");
    cast.values[0] = step;
    const PipelineStage* const stages[] = {&rays, &cast, &skip};
    StageGlsl glsl = stage_glsl(stages);
    CastParts parts{source_folder() / "plugins/abi/glsl",
                    source_folder() / "runtime/raycast/kernels",
                    glsl.resolve,
                    glsl.constants,
                    false,
                    true};
    CastPipeline made(device(), compose_cast_kernels(parts, volume));
    return pipelines_.emplace(key, std::move(made)).first->second;
  }

  Picture cast(SkipKind kind, const VolumeOnDevice& volume, const TransferTable& table,
               const SkipStructure* skip, std::span<const RayInput> rays, double step) {
    const CastPipeline& kernels = pipeline(kind, volume, step);
    const TransferOnDevice transfer(device(), table, step);
    EyeView eye;
    eye.world_from_eye = {};
    eye.width_px = eye.height_px = grid_edge;
    CastPipeline::set_eye(device(), target_, eye, {}, volume, transfer);
    std::vector<std::array<float, 4>> entries, directions;
    for (const RayInput& ray : rays) {
      entries.push_back(ray.entry);
      directions.push_back(ray.direction);
    }
    gpu::upload_values(device(), rays_.entries, std::span<const std::array<float, 4>>(entries));
    gpu::upload_values(device(), rays_.directions, std::span<const std::array<float, 4>>(directions));
    CastPipeline::Resources resources{volume, transfer, rays_, target_};
    if (skip != nullptr) resources.more = skip->bindings();
    kernels.reset_counters(device());
    gpu::CommandList commands(device(), "cast");
    commands.barrier();
    kernels.record_cast(commands, resources, {0, 0, grid_edge, grid_edge});
    commands.barrier();
    gpu::submit_and_wait(commands);
    work_ = kernels.counted(device());
    Picture picture{std::vector<std::array<std::uint32_t, 4>>(ray_count),
                    std::vector<std::uint32_t>(ray_count)};
    gpu::download_values(device(), rays_.colours, std::span<std::array<std::uint32_t, 4>>(picture.colours));
    gpu::download_values(device(), rays_.depths_m, std::span<std::uint32_t>(picture.depths));
    return picture;
  }

  /// The structure brought to a table.
  std::unique_ptr<SkipStructure> structure(const SkipScene& scene, const SkipOptions& options,
                                           const TransferTable& table) {
    auto made = make_skip_structure(kernels(), scene, options);
    bring(*made, table);
    return made;
  }
  void bring(SkipStructure& skip, const TransferTable& table) {
    gpu::CommandList commands(device(), "update");
    skip.update(commands, table);
    commands.barrier();
    gpu::submit_and_wait(commands);
  }

  WorkCounts work_;

 private:
  EyeTarget target_;
  RayBuffers rays_;
  static inline std::map<std::string, CastPipeline> pipelines_;  // for all tests
};

constexpr SkipKind skipping[] = {SkipKind::block, SkipKind::distance_map, SkipKind::partitioned,
                                 SkipKind::bitmask, SkipKind::octree};

TEST_F(SkipImages, AThousandRandomVolumesLookTheSameWithAndWithoutSkippingBitForBit) {
  Random random(21);
  const VoxelType types[] = {VoxelType::uint8, VoxelType::uint8, VoxelType::int16, VoxelType::float32};
  std::uint64_t samples_without = 0, samples_with = 0;
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const VoxelType type = types[repeat % 4];
    const Volume volume = random_volume(random, type, 12);
    MemorySource source(volume);
    const VoxelStatistics statistics = scan(volume);
    // Each fourth 8-bit volume through the sampler.
    const bool sampled = type == VoxelType::uint8 && repeat % 8 == 1;
    const VolumeOnDevice on_device(device(), source, sampled ? VolumePath::sampler : VolumePath::packed);
    SkipOptions options;
    options.kind = skipping[repeat / 4 % 5];
    options.block_voxels = random_int(random, 2, 5);
    const int counts[] = {1, 5, 16, 64, 256};
    options.partitions = counts[random_int(random, 0, 4)];
    options.placement = random_int(random, 0, 3) == 0 ? Partitions::minimum_apart : Partitions::uniform;
    options.occupancy = random_int(random, 0, 3) == 0 ? Occupancy::block : Occupancy::cell;
    options.range_minima = static_cast<RangeMinima>(random_int(random, 0, 2));
    options.lazy = options.range_minima == RangeMinima::none && random_int(random, 0, 1) == 0;
    const auto rays = random_rays(random, volume.info);
    const auto made = make_skip_structure(kernels(), {on_device, statistics}, options);
    for (int tf = 0; tf < 1 + (repeat % 3 == 0); ++tf) {
      const TransferTable table = random_table(random, statistics);
      bring(*made, table);
      const Picture plain = cast(SkipKind::none, on_device, table, nullptr, rays, 0.5);
      samples_without += work_.samples;
      const Picture skipped = cast(options.kind, on_device, table, made.get(), rays, 0.5);
      samples_with += work_.samples;
      ASSERT_TRUE(plain == skipped) << "volume " << repeat << " of " << name_of(type) << " with skip/"
                                    << to_string(options.kind) << ", table " << tf;
    }
  }
  EXPECT_LT(samples_with, samples_without * 9 / 10);  // something has been skipped
}

/// Two constant halves and a table that shows only what lies between their values: a sheet that is thinner
/// than a voxel and has no voxel of its own.
TEST_F(SkipImages, VoxelPresenceLosesTheThinBandThatCellIntervalsKeep) {
  Volume volume;
  volume.info.dims = {16, 16, 16};
  volume.voxels.assign(4096, std::byte{40});
  for (std::size_t at = 2048; at < 4096; ++at)
    volume.voxels[at] = std::byte{200};
  MemorySource source(volume);
  const VoxelStatistics statistics = scan(volume);
  const VolumeOnDevice on_device(device(), source, VolumePath::packed);
  std::vector<bool> visible(256);
  for (std::size_t i = 100; i < 130; ++i)
    visible[i] = true;
  const TransferTable table = table_of({0, 255}, visible);
  std::vector<RayInput> rays;
  for (int i = 0; i < ray_count; ++i)
    rays.push_back({{2.0f + 0.15f * static_cast<float>(i), 8.0f, 0.0f, 16.0f}, {0.0f, 0.0f, 1.0f, 0.0f}});
  const Picture plain = cast(SkipKind::none, on_device, table, nullptr, rays, 0.25);
  EXPECT_NE(plain.colours[0][3], 0u);  // the sheet is there
  for (const SkipKind kind :
       {SkipKind::distance_map, SkipKind::partitioned, SkipKind::bitmask, SkipKind::octree}) {
    SkipOptions options;
    options.kind = kind;
    const SkipScene scene{on_device, statistics};
    EXPECT_TRUE(plain == cast(kind, on_device, table, structure(scene, options, table).get(), rays, 0.25))
        << to_string(kind);
    options.occupancy = Occupancy::voxel;
    const Picture lost = cast(kind, on_device, table, structure(scene, options, table).get(), rays, 0.25);
    EXPECT_EQ(lost.colours[0][3], 0u) << to_string(kind);
  }
}

TEST_F(SkipImages, ExtremesLookTheSameBitForBit) {
  Random random(23);
  struct Extreme {
    std::array<int, 3> dims;
    int value;  // of every voxel; -1: noise
  };
  const Extreme extremes[] = {
      {{1, 1, 1}, 7}, {{3, 2, 1}, -1}, {{17, 5, 33}, 0}, {{9, 9, 9}, 255}, {{50, 3, 2}, -1}};
  for (const Extreme& extreme : extremes) {
    Volume volume;
    volume.info.dims = extreme.dims;
    volume.voxels.resize(volume.info.byte_count());
    for (auto& voxel : volume.voxels)
      voxel = static_cast<std::byte>(extreme.value < 0 ? random_int(random, 0, 255) : extreme.value);
    MemorySource source(volume);
    const VoxelStatistics statistics = scan(volume);
    const VolumeOnDevice on_device(device(), source, VolumePath::packed);
    std::vector<bool> nothing(256), one(256);
    one[200] = true;
    const TransferTable tables[] = {table_of({0, 255}, nothing), table_of({0, 255}, one),
                                    paper_table(1, {0, 255}), paper_table(2, {0, 255})};
    const auto rays = random_rays(random, volume.info);
    for (const SkipKind kind : skipping) {
      for (const int n : {1, 256}) {
        SkipOptions options;
        options.kind = kind;
        options.partitions = n;
        options.block_voxels = n == 1 ? 16 : 4;
        const auto made = make_skip_structure(kernels(), {on_device, statistics}, options);
        for (const TransferTable& table : tables) {
          bring(*made, table);
          ASSERT_TRUE(cast(SkipKind::none, on_device, table, nullptr, rays, 0.5) ==
                      cast(kind, on_device, table, made.get(), rays, 0.5))
              << to_string(kind) << " n " << n << " dims " << extreme.dims[0];
        }
      }
    }
  }
}

TEST_F(SkipImages, VoxelsThatAreNoNumbersHideNothing) {
  Random random(24);
  Volume volume;
  volume.info.dims = {13, 11, 9};
  volume.info.type = VoxelType::float32;
  volume.voxels.resize(volume.info.byte_count());
  const float odd[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(), -0.0f, 1e-40f};
  for (std::size_t i = 0; i < volume.voxels.size() / 4; ++i) {
    const float value = random_int(random, 0, 40) == 0 ? odd[i % 5] : i % 97 == 0 ? 0.8f : 0.0f;
    std::memcpy(volume.voxels.data() + 4 * i, &value, 4);
  }
  MemorySource source(volume);
  VoxelStatistics statistics = scan(volume);
  const VolumeOnDevice on_device(device(), source, VolumePath::packed);
  const TransferTable table = random_table(random, statistics);
  const TransferTable upper = paper_table(3, statistics.range);
  const auto rays = random_rays(random, volume.info);
  for (const SkipKind kind : skipping) {
    SkipOptions options;
    options.kind = kind;
    const auto made = make_skip_structure(kernels(), {on_device, statistics}, options);
    for (const TransferTable& shown : {table, upper}) {
      bring(*made, shown);
      EXPECT_TRUE(cast(SkipKind::none, on_device, shown, nullptr, rays, 0.5) ==
                  cast(kind, on_device, shown, made.get(), rays, 0.5))
          << to_string(kind);
    }
  }
}

std::filesystem::path real_volumes() {
  const char* shared = std::getenv("BRACE_SHARED_DIR");
  return (shared != nullptr ? std::filesystem::path(shared) : source_folder() / "../shared") / "data/volumes";
}

/// Every so many voxels of a real volume, so that no edge is longer than `edge_max`.
Volume thinned(const VolumeInfo& info, std::span<const std::byte> voxels, int edge_max) {
  const int longest = *std::max_element(info.dims.begin(), info.dims.end());
  const int every = (longest + edge_max - 1) / edge_max;
  Volume thin;
  thin.info = info;
  for (int& dim : thin.info.dims)
    dim = (dim + every - 1) / every;
  thin.voxels.resize(thin.info.byte_count());
  const std::size_t size = info.byte_count() / static_cast<std::size_t>(info.voxel_count());
  std::size_t to = 0;
  for (int z = 0; z < info.dims[2]; z += every)
    for (int y = 0; y < info.dims[1]; y += every)
      for (int x = 0; x < info.dims[0]; x += every, to += size) {
        const auto at = (static_cast<std::size_t>(z) * static_cast<std::size_t>(info.dims[1]) +
                         static_cast<std::size_t>(y)) *
                            static_cast<std::size_t>(info.dims[0]) +
                        static_cast<std::size_t>(x);
        std::copy_n(voxels.begin() + static_cast<std::ptrdiff_t>(at * size), size,
                    thin.voxels.begin() + static_cast<std::ptrdiff_t>(to));
      }
  return thin;
}

TEST_F(SkipImages, RealVolumesLookTheSameBitForBitUnderTf1ToTf6WithEveryStructure) {
  if (!std::filesystem::is_directory(real_volumes()))
    GTEST_SKIP() << real_volumes() << " is not there: set BRACE_SHARED_DIR";
  const int edge_max = std::getenv("BRACE_LONG_TESTS") != nullptr ? 1024 : 64;
  Random random(25);
  int volumes = 0;
  std::uint64_t samples_without = 0, samples_with = 0;
  for (const auto& entry : std::filesystem::directory_iterator(real_volumes())) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".raw") || name.ends_with(".txt") || name.ends_with(".md")) continue;
    const auto opened = open_volume(entry.path().string());
    const VolumeInfo& info = opened->info();
    std::vector<std::byte> voxels(info.byte_count());
    opened->read_slab(voxels, 0, info.dims[2]);
    const Volume volume = thinned(info, voxels, edge_max);
    MemorySource source(volume);
    const VoxelStatistics statistics = scan(volume);
    const VolumeOnDevice on_device(device(), source, VolumePath::packed);
    const std::array<std::vector<RayInput>, 2> rays = {random_rays(random, volume.info),
                                                       random_rays(random, volume.info)};
    for (const SkipKind kind : skipping) {
      SkipOptions options;
      options.kind = kind;
      const auto made = make_skip_structure(kernels(), {on_device, statistics}, options);
      for (int tf = 1; tf <= 6; ++tf) {
        const TransferTable table = paper_table(tf, statistics.range);
        bring(*made, table);
        for (const auto& some : rays) {
          const Picture plain = cast(SkipKind::none, on_device, table, nullptr, some, 0.5);
          samples_without += work_.samples;
          ASSERT_TRUE(plain == cast(kind, on_device, table, made.get(), some, 0.5))
              << name << " TF" << tf << " skip/" << to_string(kind);
          samples_with += work_.samples;
        }
      }
    }
    ++volumes;
  }
  EXPECT_GT(volumes, 0);
  EXPECT_LT(samples_with, samples_without);
}

}  // namespace
}  // namespace brace
