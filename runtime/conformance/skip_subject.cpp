// skip: a native stage's distance map against brute force; a GLSL stage's picture against the unskipped one.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "runtime/conformance/bench_scene.hpp"
#include "runtime/skip/first_hit_maps.hpp"
#include "runtime/skip/skip_structure.hpp"

namespace brace {

namespace {

/// Distance in blocks to the nearest block that may show something, per block; -1 where there is none.
std::vector<int> true_distances(const BenchScene& scene, const brace_skip_frame& frame) {
  const Volume& volume = scene.host_volume;
  const std::array<int, 3>& dims = volume.info.dims;
  const auto visible = [&](double low, double high) {
    // The table is linear between entries: look at those in the interval and at both ends.
    if (lookup(scene.table, low).kappa > 0.0 || lookup(scene.table, high).kappa > 0.0) return true;
    for (double v = std::ceil(low); v <= high; v += 1.0) {
      if (lookup(scene.table, v).kappa > 0.0) return true;
    }
    return false;
  };
  const auto n = [&](std::size_t axis) { return static_cast<int>(frame.blocks[axis]); };
  const auto edge = static_cast<int>(frame.block_edge_voxels);
  std::vector<std::array<int, 3>> occupied;
  std::vector<int> distances(static_cast<std::size_t>(n(0) * n(1) * n(2)), -1);
  const auto block_is_occupied = [&](int bx, int by, int bz) {
    // Cells are between voxel centres; -1 and dims - 1 are those at the edge.
    for (int z = bz * edge - 1; z < std::min((bz + 1) * edge, dims[2]); ++z) {
      for (int y = by * edge - 1; y < std::min((by + 1) * edge, dims[1]); ++y) {
        for (int x = bx * edge - 1; x < std::min((bx + 1) * edge, dims[0]); ++x) {
          double low = 1e300, high = -1e300;
          for (int corner = 0; corner < 8; ++corner) {
            const int cx = std::clamp(x + (corner & 1), 0, dims[0] - 1);
            const int cy = std::clamp(y + (corner >> 1 & 1), 0, dims[1] - 1);
            const int cz = std::clamp(z + (corner >> 2), 0, dims[2] - 1);
            const double value = voxel_value(volume, cx, cy, cz);
            low = std::min(low, value), high = std::max(high, value);
          }
          if (visible(low, high)) return true;
        }
      }
    }
    return false;
  };
  for (int z = 0; z < n(2); ++z) {
    for (int y = 0; y < n(1); ++y) {
      for (int x = 0; x < n(0); ++x) {
        if (block_is_occupied(x, y, z)) occupied.push_back({x, y, z});
      }
    }
  }
  for (int z = 0, at = 0; z < n(2); ++z) {
    for (int y = 0; y < n(1); ++y) {
      for (int x = 0; x < n(0); ++x, ++at) {
        int nearest = occupied.empty() ? -1 : 1 << 20;
        for (const auto& o : occupied) {
          nearest = std::min(nearest, std::max({std::abs(o[0] - x), std::abs(o[1] - y), std::abs(o[2] - z)}));
        }
        distances[static_cast<std::size_t>(at)] = nearest;
      }
    }
  }
  return distances;
}

class NativeSkipSubject final : public Subject {
 public:
  NativeSkipSubject(const StageInfo& stage, const CheckOptions& options)
      : info_(stage), options_(options), scene_(*options.device), commands_(*options.device, "conformance") {}

  void make(const std::vector<double>& values) override {
    counted([&] { stage_ = NativeStage({info_, values}); });
  }

  void activate() override {
    counted([&] {
      activation_ = std::make_unique<StageActivation>(activation_input(
          *options_.device, scene_.volume, scene_.placement, scene_.table, BenchScene::step_units, 24, 16));
      stage_.activate(activation_->get());
    });
    frame_ = {};
    frame_.struct_size = sizeof frame_;
    frame_.block_edge_voxels = stage_.block_edge_voxels();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto dim = static_cast<std::uint32_t>(scene_.host_volume.info.dims[axis]);
      frame_.blocks[axis] = (dim + frame_.block_edge_voxels - 1) / frame_.block_edge_voxels;
    }
    frame_.row_bytes = (frame_.blocks[0] + 15) / 16 * 16;
    frame_.slice_bytes = std::uint64_t{frame_.row_bytes} * frame_.blocks[1];
    const std::uint64_t bytes = frame_.slice_bytes * frame_.blocks[2];
    if (map_.size_bytes() != bytes) map_ = GuardedBuffer(*options_.device, "distances", bytes);
    frame_.distances = map_.range();
    frame_.transfer = &activation_->transfer();
  }

  Trial use() override {
    Trial trial;
    trial.outputs = update(first_fill, &trial.allocations);
    trial.values = trial.outputs.size();
    return trial;
  }

  void deactivate() override {
    // The voxels' reader is the host's, but opened in the stage's name: it goes with the activation.
    counted([&] {
      stage_.deactivate();
      activation_.reset();
    });
  }
  void unmake() override {
    counted([&] { stage_ = NativeStage(); });
  }
  bool is_native() const override { return true; }
  bool runs_on_host() const override {
    return static_cast<const brace_skip_functions*>(info_.native->functions)->execute_update != nullptr;
  }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    std::vector<std::byte> a, b;
    std::vector<int> truth;
    std::uint64_t spoilt = 0;
    suite.prepare("builds a map", [&] {
      const Life life(*this, values);
      a = update(first_fill, nullptr);
      spoilt += map_.spoilt(*options_.device);
      b = update(second_fill, nullptr);
      spoilt += map_.spoilt(*options_.device);
      truth = true_distances(scene_, frame_);
    });
    suite.clause("every block is written", [&] {
      std::uint64_t kept = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        kept += a[i] == std::byte{0xff} && b[i] == std::byte{0x2b} ? 1u : 0u;
      return none_of(kept, a.size(), "blocks were left as they were");
    });
    suite.clause("no distance reaches past a visible block", [&] {
      std::uint64_t over = 0;
      for (std::size_t i = 0; i < b.size(); ++i) {
        const bool written = a[i] != std::byte{0xff} || b[i] != std::byte{0x2b};
        over += written && truth[i] >= 0 && std::to_integer<int>(b[i]) > truth[i] ? 1u : 0u;
      }
      return none_of(over, b.size(), "blocks with too large a distance");
    });
    suite.clause("nothing behind the buffers",
                 [&] { return none_of(spoilt, watchdog_guard_bytes / 2, "guard words overwritten"); });
  }

 private:
  /// The blocks' bytes without the padding of rows.
  std::vector<std::byte> update(std::uint32_t before, std::uint64_t* allocations) {
    const gpu::Device& device = *options_.device;
    map_.fill(device, before);
    if (stage_.skips_on_host()) {
      std::vector<std::byte> copy;
      brace_skip_frame frame = frame_;
      if (frame.distances.mapped == nullptr) {
        copy = map_.read(device);
        frame.distances.mapped = copy.data();
      }
      const std::uint64_t counted = allocations_of_this_thread().allocations;
      stage_.update_skip(frame);
      if (allocations != nullptr) *allocations += allocations_of_this_thread().allocations - counted;
      if (!copy.empty()) map_.write(device, copy);
    } else {
      commands_.reset();
      frame_.commands = commands_.hand_out();
      stage_.update_skip(frame_);
      commands_.barrier();
      (void)gpu::submit_and_wait(commands_);
    }
    const std::vector<std::byte> all = map_.read(device);
    std::vector<std::byte> blocks;
    for (std::uint64_t z = 0; z < frame_.blocks[2]; ++z) {
      for (std::uint64_t y = 0; y < frame_.blocks[1]; ++y) {
        append(blocks, all.data() + z * frame_.slice_bytes + y * frame_.row_bytes, frame_.blocks[0]);
      }
    }
    return blocks;
  }

  StageInfo info_;
  CheckOptions options_;
  BenchScene scene_;
  gpu::CommandList commands_;
  NativeStage stage_;
  std::unique_ptr<StageActivation> activation_;
  brace_skip_frame frame_{};
  GuardedBuffer map_;
};

/// One whose structure comes with Brace gets it; another works with what is bound anyway.
class GlslSkipSubject final : public Subject {
 public:
  GlslSkipSubject(const StageInfo& stage, const CheckOptions& options)
      : info_(stage),
        options_(options),
        scene_(*options.device),
        kernels_(*options.device, options.data_folder / "kernels" / "skip"),
        commands_(*options.device, "conformance") {}

  void make(const std::vector<double>& values) override {
    rays_ = RayBuffers(*options_.device, usual_size.width, usual_size.height);
    target_ = EyeTarget(*options_.device, usual_size.width, usual_size.height);
    make_structure({info_, values});
    const std::vector<gpu::Binding> more = bindings();
    pipeline_ = bench_pipeline(options_, scene_, {info_, values},
                               {{"rays", plain_rays_snippet}, {"cast", plain_cast_snippet}}, more);
  }
  void activate() override {}
  void deactivate() override {}
  void unmake() override {}
  bool is_native() const override { return false; }
  bool runs_on_host() const override { return false; }

  Trial use() override {
    Trial trial;
    for (const BenchView view : bench_views) {
      if (first_hits_) cast(view);  // the next frame knows of this one
      cast(view);
      for (const gpu::Buffer* buffer : {&rays_.colours, &rays_.depths_m}) {
        std::vector<std::byte> bytes(buffer->size_bytes());
        gpu::download(*options_.device, *buffer, bytes);
        append(trial.outputs, bytes.data(), bytes.size());
      }
      trial.values += 24 * 16;
    }
    return trial;
  }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    suite.clause("the picture is the unskipped one, bit for bit", [&] {
      make(values);
      const Trial skipped = use();
      pipeline_ = bench_pipeline(options_, scene_, {info_, values},
                                 {{"rays", plain_rays_snippet}, {"cast", plain_cast_snippet}, {"skip", ""}});
      const Trial plain = use();
      std::uint64_t bad = 0;
      for (std::size_t i = 0; i < plain.outputs.size(); i += 4) {
        bad += std::memcmp(&plain.outputs[i], &skipped.outputs[i], 4) != 0 ? 1u : 0u;
      }
      return none_of(bad, plain.outputs.size() / 4, "words differ");
    });
  }

 private:
  void make_structure(const PipelineStage& stage) {
    structure_.reset();
    first_hits_.reset();
    const std::string ours = (options_.data_folder / "stages").string();
    if (!info_.origin.string().starts_with(ours)) return;
    const SkipOptions options = skip_options(stage);
    structure_ =
        make_skip_structure(kernels_, {scene_.volume, scene_.scan.result(), {&scene_.table, 1}}, options);
    if (structure_) {
      commands_.reset();
      structure_->update(commands_, scene_.table);
      gpu::submit_and_wait(commands_);
    }
    if (info_.name == "occlusion")
      first_hits_.emplace(kernels_, occlusion_settings(stage), usual_size.width, usual_size.height);
  }

  std::vector<gpu::Binding> bindings() {
    std::vector<gpu::Binding> all;
    if (structure_) all.assign(structure_->bindings().begin(), structure_->bindings().end());
    if (first_hits_)
      for (const gpu::Binding& binding : first_hits_->bindings(0))
        all.push_back(binding);
    return all;
  }

  void cast(BenchView view) {
    const EyeView eye = bench_eye(view, usual_size);
    CastPipeline::set_eye(*options_.device, target_, eye, scene_.placement, scene_.volume, scene_.transfer);
    if (first_hits_) first_hits_->aim(0, eye, scene_.volume.info(), scene_.placement, 0);
    const std::vector<gpu::Binding> more = bindings();
    commands_.reset();
    pipeline_.record(commands_, {scene_.volume, scene_.transfer, rays_, target_, more});
    if (first_hits_) first_hits_->record(commands_, 0, target_);
    gpu::submit_and_wait(commands_);
  }

  StageInfo info_;
  CheckOptions options_;
  BenchScene scene_;
  SkipKernels kernels_;
  gpu::CommandList commands_;
  std::unique_ptr<SkipStructure> structure_;  // null where the stage has none
  std::optional<FirstHitMaps> first_hits_;    // of skip/occlusion
  CastPipeline pipeline_;
  RayBuffers rays_;
  EyeTarget target_;
};

}  // namespace

std::unique_ptr<Subject> make_skip_subject(const StageInfo& stage, const CheckOptions& options) {
  if (options.device == nullptr)
    throw device_error("stage {} wants a Vulkan device to be checked", stage.id());
  if (stage.native != nullptr) return std::make_unique<NativeSkipSubject>(stage, options);
  return std::make_unique<GlslSkipSubject>(stage, options);
}

}  // namespace brace
