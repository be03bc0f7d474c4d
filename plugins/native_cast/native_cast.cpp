// cast/native: the ray caster for machines without a GPU, as a native stage that executes on the host. SIMD
// lanes are rays (cast_area.cpp); tiles of rays are shared out to threads by work stealing (oneTBB).
#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include "caster.hpp"
#include "glsl/brace/light_directions.h"

namespace {

using namespace native_cast;

// A tile is what one thread takes at a time: large enough that taking it costs nothing, small enough that 64
// threads find work in a picture of 512 x 512. Whole packets of rays fit, whatever the instruction set; so
// the picture is cut into tiles, not halved until a part is small enough.
constexpr std::uint32_t tile_px = 32;

enum Parameter {
  step_voxels,
  termination_opacity,
  ambient,
  diffuse,
  specular,
  shininess,
  threads,
  instructions,
  parameter_count
};

/// "auto" and the instruction sets of this processor: the choices of a parameter.
struct InstructionNames {
  InstructionNames() : sets(instruction_sets()) {
    names.push_back("auto");
    for (const std::string& set : sets)
      names.push_back(set.c_str());
    names.push_back(nullptr);
  }
  std::vector<std::string> sets;
  std::vector<const char*> names;
};
const InstructionNames instruction_names;

const brace_param parameters[parameter_count] = {
    {sizeof(brace_param), "step_voxels", BRACE_PARAM_FLOAT, "voxels",
     "Distance between samples in the smallest voxel spacing", 0.01, 64.0, 0.5, nullptr},
    {sizeof(brace_param), "termination_opacity", BRACE_PARAM_FLOAT, "",
     "A ray ends when it is this opaque; 1 lets every ray run through", 0.01, 1.0, 0.99, nullptr},
    {sizeof(brace_param), "ambient", BRACE_PARAM_FLOAT, "",
     "Share of a sample's colour that does not depend on the light (shading = \"phong\")", 0.0, 1.0, 0.3,
     nullptr},
    {sizeof(brace_param), "diffuse", BRACE_PARAM_FLOAT, "",
     "Share of a sample's colour lit by the light at the eye (shading = \"phong\")", 0.0, 1.0, 0.7, nullptr},
    {sizeof(brace_param), "specular", BRACE_PARAM_FLOAT, "",
     "Strength of the white highlight (shading = \"phong\")", 0.0, 1.0, 0.2, nullptr},
    {sizeof(brace_param), "shininess", BRACE_PARAM_FLOAT, "",
     "Exponent of the highlight: larger is smaller and sharper (shading = \"phong\")", 1.0, 256.0, 32.0,
     nullptr},
    {sizeof(brace_param), "threads", BRACE_PARAM_INT, "", "Threads, at most the machine's; 0: all of them",
     0.0, 256.0, 0.0, nullptr},
    {sizeof(brace_param), "instructions", BRACE_PARAM_CHOICE, "",
     "Instruction set; auto: the best that the processor has", 0.0,
     static_cast<double>(instruction_names.sets.size()), 0.0, instruction_names.names.data()}};

class NativeCast {
 public:
  explicit NativeCast(const double* values) { std::copy(values, values + parameter_count, values_.begin()); }

  brace_result activate(const brace_activation& with) {
    if (with.volume == nullptr) return fail(BRACE_UNSUPPORTED, "needs a volume");
    choose_instruction_set(instruction_names.names[static_cast<std::size_t>(values_[instructions])]);
    const brace_result read = volume_.read(*with.volume, error_);
    if (read != BRACE_OK) return read;
    // More threads than the machine has would only wait for each other.
    const int there = tbb::this_task_arena::max_concurrency();
    const int asked = static_cast<int>(values_[threads]);
    const int concurrency = asked == 0 ? there : std::min(asked, there);
    arena_ = std::make_unique<tbb::task_arena>(concurrency);
    arena_->initialize();
    scene_ = Scene{};
    scene_.volume = &volume_;
    scene_.step_units = static_cast<float>(values_[step_voxels]);
    scene_.opaque_transmittance =
        values_[termination_opacity] < 1.0 ? 1.0f - static_cast<float>(values_[termination_opacity]) : -1.0f;
    return take_shading(with);
  }

  void deactivate() {
    arena_.reset();
    volume_ = {};
  }

  brace_result execute(const brace_cast_frame& frame) {
    if (frame.params.mapped == nullptr || frame.ray_entries.mapped == nullptr ||
        frame.transfer.mapped == nullptr)
      return fail(BRACE_INVALID_ARGUMENT, "a range that a cast on the host needs is not mapped");
    std::memcpy(&scene_.eye, frame.params.mapped, sizeof scene_.eye);
    take_transfer(static_cast<const float*>(frame.transfer.mapped));
    take_skip_map(frame);
    const Rays rays{static_cast<const float*>(frame.ray_entries.mapped),
                    static_cast<const float*>(frame.ray_directions.mapped),
                    static_cast<float*>(frame.result_colours.mapped),
                    static_cast<float*>(frame.result_depths_m.mapped), frame.rays_across};
    scene_.segments = nullptr;
    if (frame.struct_size >= offsetof(brace_cast_frame, segments) + sizeof frame.segments)
      scene_.segments = frame.segments;
    brace_work_counts counts{};
    const brace_result done = cast_tiles(rays, frame.area, counts);
    if (done != BRACE_OK) return fail(done, "its segments were not taken");
    if (frame.counted != nullptr) {
      frame.counted->rays += counts.rays;
      frame.counted->samples += counts.samples;
      frame.counted->skip_steps += counts.skip_steps;
      frame.counted->shading_fetches += counts.shading_fetches;
    }
    return BRACE_OK;
  }

  const char* last_error() const { return error_.c_str(); }

  brace_result fail(brace_result result, std::string why) {
    error_ = std::move(why);
    return result;
  }

 private:
  brace_result take_shading(const brace_activation& with) {
    if (with.struct_size < sizeof with) return BRACE_OK;  // an older host: unlit
    if (with.shading < BRACE_SHADING_NONE || with.shading > BRACE_SHADING_RANDOM_LIGHTS)
      return fail(BRACE_UNSUPPORTED, "does not know this shading");
    if (with.shading_samples > BRACE_LIGHTS_MAX * BRACE_SAMPLES_PER_LIGHT)
      return fail(BRACE_UNSUPPORTED, "takes up to 64 shading samples");
    Shading& shading = scene_.shading;
    shading = {with.shading, static_cast<float>(values_[ambient]), static_cast<float>(values_[diffuse]),
               static_cast<float>(values_[specular]), static_cast<float>(values_[shininess])};
    shading.samples = static_cast<int>(with.shading_samples);
    shading.step_units = static_cast<float>(with.shading_step_units);
    for (int axis = 0; axis < 3; ++axis)
      shading.light[axis] = static_cast<float>(with.shading_light[axis]);
    return BRACE_OK;
  }

  void take_transfer(const float* entries) {
    const auto count = static_cast<std::size_t>(scene_.eye.transfer[2]);
    segments_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        segments_[i].entry[c] = entries[4 * i + c];
        segments_[i].rise[c] = entries[4 * i + 4 + c] - entries[4 * i + c];
      }
    }
    scene_.transfer_segments = segments_.data();
    scene_.last_segment = static_cast<std::int32_t>(count) - 1;
  }

  void take_skip_map(const brace_cast_frame& frame) {
    scene_.skip_map = BRACE_SKIP_MAP_NONE;
    if (frame.struct_size < offsetof(brace_cast_frame, skip_params) + sizeof frame.skip_params) return;
    if (frame.skip_words.mapped == nullptr || frame.skip_params.mapped == nullptr) return;
    scene_.skip_map = frame.skip_map;
    scene_.skip_words = static_cast<const std::uint32_t*>(frame.skip_words.mapped);
    std::memcpy(&scene_.skip, frame.skip_params.mapped, sizeof scene_.skip);
  }

  brace_result cast_tiles(const Rays& rays, const brace_area& area, brace_work_counts& all) {
    std::array<std::atomic<std::uint64_t>, 4> sums{};
    std::atomic<brace_result> result{BRACE_OK};
    const auto cast = [&](const tbb::blocked_range2d<std::uint32_t>& tile) {
      const std::uint32_t x = tile.cols().begin() * tile_px, y = tile.rows().begin() * tile_px;
      const brace_area part{area.x + x, area.y + y, std::min(tile_px, area.width - x),
                            std::min(tile_px, area.height - y)};
      brace_work_counts counts{};
      const brace_result done = cast_area(scene_, rays, part, counts);
      if (done != BRACE_OK) result = done;
      const std::uint64_t counted[4] = {counts.rays, counts.samples, counts.skip_steps,
                                        counts.shading_fetches};
      for (std::size_t i = 0; i < 4; ++i)
        sums[i].fetch_add(counted[i], std::memory_order_relaxed);
    };
    const std::uint32_t across = (area.width + tile_px - 1) / tile_px;
    const std::uint32_t down = (area.height + tile_px - 1) / tile_px;
    arena_->execute([&] {
      tbb::parallel_for(tbb::blocked_range2d<std::uint32_t>(0, down, 1, 0, across, 1), cast,
                        tbb::simple_partitioner());
    });
    all.rays = sums[0];
    all.samples = sums[1];
    all.skip_steps = sums[2];
    all.shading_fetches = sums[3];
    return result;
  }

  std::array<double, parameter_count> values_{};
  PackedVolume volume_;
  std::unique_ptr<tbb::task_arena> arena_;
  std::vector<TransferSegment> segments_;
  Scene scene_;
  std::string error_;
};

// No exception leaves a function of the interface.
template <typename Call>
brace_result guarded(NativeCast& self, Call&& call) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return self.fail(BRACE_ERROR, "out of memory");
  } catch (const std::exception& error) {
    return self.fail(BRACE_ERROR, error.what());
  } catch (...) {
    return self.fail(BRACE_ERROR, "an unexpected exception");
  }
}

extern "C" {

static void* create(const double* values, uint32_t count) {
  return count == parameter_count ? new (std::nothrow) NativeCast(values) : nullptr;
}
static void destroy(void* self) {
  delete static_cast<NativeCast*>(self);
}
static brace_result activate(void* self, const brace_activation* activation) {
  auto& stage = *static_cast<NativeCast*>(self);
  return guarded(stage, [&] { return stage.activate(*activation); });
}
static void deactivate(void* self) {
  static_cast<NativeCast*>(self)->deactivate();
}
static brace_result execute(void* self, const brace_cast_frame* frame) {
  auto& stage = *static_cast<NativeCast*>(self);
  return guarded(stage, [&] { return stage.execute(*frame); });
}
static const char* last_error(void* self) {
  return static_cast<const NativeCast*>(self)->last_error();
}

}  // extern "C"

const brace_cast_functions functions = {sizeof functions, nullptr, execute, 1};

const brace_stage_descriptor descriptor = {
    sizeof descriptor,
    BRACE_KIND_CAST,
    "native",
    "1.0.0",
    "Direct volume rendering on the CPU: SIMD lanes are rays, threads take tiles",
    parameters,
    parameter_count,
    create,
    destroy,
    &functions,
    activate,
    deactivate,
    last_error};

const brace_stage_descriptor* const stages[] = {&descriptor};

}  // namespace

extern "C" BRACE_EXPORT brace_result brace_library_entry(const brace_host* host, brace_library* library) {
  return brace_fill_library(host, library, "native_cast", "1.0.0", stages, 1);
}
