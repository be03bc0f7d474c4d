// cast: rays in, colour and first-hit depth out.
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "runtime/conformance/bench_scene.hpp"

namespace brace {

namespace {

/// What came out of one cast, and what became of everything around it.
struct CastOutput {
  std::vector<float> entries;                    // 4 per ray, as before
  std::vector<std::uint32_t> colours, depths_m;  // bits
  bool inputs_changed = false;
  std::uint64_t spoilt = 0;  // words behind the buffers
  Trial calls;               // allocations of the calls into a native stage
};

/// Results that break the contract, by clause.
struct CastFaults {
  std::uint64_t rays = 0, not_finite = 0, colour = 0, opacity = 0, depth = 0, painted_misses = 0;

  bool any() const { return not_finite + colour + opacity + depth + painted_misses != 0; }
};

CastFaults judge(const CastOutput& output) {
  CastFaults faults;
  faults.rays = output.depths_m.size();
  for (std::size_t ray = 0; ray < output.depths_m.size(); ++ray) {
    if (output.depths_m[ray] == second_fill && output.colours[4 * ray] == second_fill)
      continue;  // not written
    float c[4], depth = 0.0f;
    std::memcpy(c, &output.colours[4 * ray], sizeof c);
    std::memcpy(&depth, &output.depths_m[ray], sizeof depth);
    const bool finite = std::isfinite(c[0]) && std::isfinite(c[1]) && std::isfinite(c[2]) &&
                        std::isfinite(c[3]) && !std::isnan(depth) && depth != -INFINITY;
    if (!finite) {
      ++faults.not_finite;
      continue;
    }
    constexpr float slack = 1e-6f;
    if (c[3] < -slack || c[3] > 1.0f + slack) ++faults.opacity;
    for (int channel = 0; channel < 3; ++channel) {
      if (c[channel] >= -slack && c[channel] <= c[3] + slack) continue;
      ++faults.colour;
      break;
    }
    if (depth < 0.0f || (c[3] > 0.0f && std::isinf(depth))) ++faults.depth;
    const bool misses = !(output.entries[4 * ray + 3] > 0.0f);
    if (misses && (c[0] != 0.0f || c[1] != 0.0f || c[2] != 0.0f || c[3] != 0.0f || !std::isinf(depth))) {
      ++faults.painted_misses;
    }
  }
  return faults;
}

class CastSubject final : public Subject {
 public:
  CastSubject(const StageInfo& stage, const CheckOptions& options)
      : info_(stage), options_(options), scene_(*options.device), commands_(*options.device, "conformance") {}

  void make(const std::vector<double>& values) override {
    const PipelineStage stage{info_, values};
    std::vector<std::pair<std::string, std::string>> snippets = {{"rays", plain_rays_snippet}};
    if (is_native()) snippets.emplace_back("cast", empty_cast_snippet);
    if (!is_native() || !native_pipeline_made_) pipeline_ = bench_pipeline(options_, scene_, stage, snippets);
    native_pipeline_made_ = is_native();
    if (is_native()) {
      counted([&] { native_ = NativeStage(stage); });
    }
    set_size(size_);
  }

  void activate() override {
    if (!is_native()) return;
    const ActivationInput input =
        activation_input(*options_.device, scene_.volume, scene_.placement, scene_.table,
                         BenchScene::step_units, size_.width, size_.height);
    counted([&] {
      activation_ = std::make_unique<StageActivation>(input);
      native_.activate(activation_->get());
    });
  }

  Trial use() override {
    Trial trial;
    for (const BenchView view : bench_views) {
      const CastOutput output = cast(view, second_fill, whole());
      trial.allocations += output.calls.allocations;
      trial.values += output.depths_m.size();
      append(trial.outputs, output.colours.data(), output.colours.size());
      append(trial.outputs, output.depths_m.data(), output.depths_m.size());
      const CastFaults faults = judge(output);
      if (faults.any()) trial.violation = fmt::format("results of {} rays break the contract", faults.rays);
    }
    return trial;
  }

  void deactivate() override {
    // The voxels' reader is the host's, but opened in the stage's name: it goes with the activation.
    counted([&] {
      native_.deactivate();
      activation_.reset();
    });
  }
  void unmake() override {
    counted([&] { native_ = NativeStage(); });
  }
  bool is_native() const override { return info_.native != nullptr; }
  bool runs_on_host() const override { return native_on_host(); }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    std::uint64_t spoilt = 0;
    suite.clause("sizes from 1x1 to odd to large", [&] { return check_sizes(values, spoilt); });
    CastFaults faults;
    std::uint64_t unwritten = 0;
    bool changed = false;
    suite.prepare("casts from outside, inside and past the volume", [&] {
      const Life life(*this, values);
      for (const BenchView view : bench_views) {
        const CastOutput a = cast(view, first_fill, whole());
        const CastOutput b = cast(view, second_fill, whole());
        add(faults, judge(b));
        unwritten += count_unwritten(a, b);
        changed = changed || a.inputs_changed || b.inputs_changed;
        spoilt += a.spoilt + b.spoilt;
      }
    });
    const std::uint64_t rays = faults.rays;
    suite.clause("every ray is written",
                 [&] { return none_of(unwritten, rays, "rays were left as they were"); });
    suite.clause("results are finite",
                 [&] { return none_of(faults.not_finite, rays, "rays with NaN or Inf"); });
    suite.clause("colours within [0, opacity]", [&] { return none_of(faults.colour, rays, "rays outside"); });
    suite.clause("opacity within [0, 1]", [&] { return none_of(faults.opacity, rays, "rays outside"); });
    suite.clause("depths are distances", [&] {
      return none_of(faults.depth, rays, "rays with a depth below zero, or visible without one");
    });
    suite.clause("rays that miss stay transparent",
                 [&] { return none_of(faults.painted_misses, rays, "rays painted"); });
    suite.clause("inputs are left alone", [&] {
      if (changed) throw Broken("rays or parameters were overwritten");
      return std::string("rays and parameters unchanged");
    });
    suite.clause("nothing behind the buffers", [&] {
      return none_of(spoilt, 2 * 2 * watchdog_guard_bytes / 4, "guard words overwritten");
    });
    suite.clause("nothing outside the area", [&] { return check_area(values); });
  }

 private:
  bool native_on_host() const {
    return is_native() &&
           static_cast<const brace_cast_functions*>(info_.native->functions)->execute != nullptr;
  }

  CastArea whole() const { return {0, 0, size_.width, size_.height}; }

  void set_size(PictureSizePx size) {
    size_ = size;
    rays_ = RayBuffers(*options_.device, size.width, size.height, watchdog_guard_bytes);
    target_ = EyeTarget(*options_.device, size.width, size.height);
  }

  static void add(CastFaults& to, const CastFaults& more) {
    to.rays += more.rays;
    to.not_finite += more.not_finite;
    to.colour += more.colour;
    to.opacity += more.opacity;
    to.depth += more.depth;
    to.painted_misses += more.painted_misses;
  }

  static std::uint64_t count_unwritten(const CastOutput& a, const CastOutput& b) {
    std::uint64_t rays = 0;
    for (std::size_t ray = 0; ray < a.depths_m.size(); ++ray) {
      // The two casts began with different bits: what kept them was not written.
      bool kept = a.depths_m[ray] == first_fill && b.depths_m[ray] == second_fill;
      for (std::size_t c = 0; c < 4; ++c) {
        kept = kept || (a.colours[4 * ray + c] == first_fill && b.colours[4 * ray + c] == second_fill);
      }
      if (kept) ++rays;
    }
    return rays;
  }

  void fill(const gpu::Buffer& buffer, std::uint32_t word) {
    const std::vector<std::uint32_t> words(buffer.size_bytes() / 4, word);
    gpu::upload_values(*options_.device, buffer, std::span<const std::uint32_t>(words));
    arm_guard(*options_.device, buffer);
  }

  std::vector<std::byte> inputs() const {
    std::vector<std::byte> all;
    for (const gpu::Buffer* buffer : {&rays_.entries, &rays_.directions, &target_.params}) {
      std::vector<std::byte> bytes(buffer->size_bytes());
      gpu::download(*options_.device, *buffer, bytes);
      append(all, bytes.data(), bytes.size());
    }
    return all;
  }

  CastOutput cast(BenchView view, std::uint32_t before, const CastArea& area) {
    const gpu::Device& device = *options_.device;
    const EyeView eye = bench_eye(view, size_);
    CastPipeline::set_eye(device, target_, eye, scene_.placement, scene_.volume, scene_.transfer);
    const CastPipeline::Resources resources{scene_.volume, scene_.transfer, rays_, target_};
    commands_.reset();
    pipeline_.record_opening(commands_, resources, whole());
    commands_.barrier();
    (void)gpu::submit_and_wait(commands_);
    fill(rays_.colours, before);
    fill(rays_.depths_m, before);
    const std::vector<std::byte> inputs_before = inputs();

    CastOutput output;
    EyeCast one{device, pipeline_, resources, eye};
    one.cast = &native_;
    commands_.reset();
    commands_.barrier();
    if (native_on_host()) {
      WorkCounts work;
      counted([&] { execute_cast(one, area, host_rays_, work); }, &output.calls);
    } else if (is_native()) {
      native_.cast(cast_frame(one, commands_.hand_out(), area));
    } else {
      pipeline_.record_cast(commands_, resources, area);
    }
    commands_.barrier();
    (void)gpu::submit_and_wait(commands_);

    output.inputs_changed = inputs() != inputs_before;
    output.spoilt = spoilt_words(device, rays_.colours) + spoilt_words(device, rays_.depths_m);
    const auto rays = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
    output.entries.resize(4 * rays);
    output.colours.resize(4 * rays);
    output.depths_m.resize(rays);
    std::memcpy(output.entries.data(), inputs_before.data(), 16 * rays);
    gpu::download_values(device, rays_.colours, std::span<std::uint32_t>(output.colours));
    gpu::download_values(device, rays_.depths_m, std::span<std::uint32_t>(output.depths_m));
    return output;
  }

  std::string check_sizes(const std::vector<double>& values, std::uint64_t& spoilt) {
    std::string sizes;
    for (const PictureSizePx size : bench_sizes(options_)) {
      size_ = size;
      try {
        const Life life(*this, values);
        const CastOutput output = cast(BenchView::outside, first_fill, whole());
        spoilt += output.spoilt;
      } catch (const std::runtime_error& failed) {
        size_ = usual_size;
        throw Broken(fmt::format("{}x{}: {}", size.width, size.height, failed.what()));
      }
      sizes += fmt::format("{}{}x{}", sizes.empty() ? "" : ", ", size.width, size.height);
    }
    size_ = usual_size;
    return sizes;
  }

  std::string check_area(const std::vector<double>& values) {
    const Life life(*this, values);
    const CastArea part{5, 3, 11, 7};
    const CastOutput output = cast(BenchView::outside, second_fill, part);
    std::uint64_t outside = 0, touched = 0;
    for (int y = 0; y < size_.height; ++y) {
      for (int x = 0; x < size_.width; ++x) {
        if (x >= part.x && x < part.x + part.width && y >= part.y && y < part.y + part.height) continue;
        const auto ray = static_cast<std::size_t>(y * size_.width + x);
        ++outside;
        if (output.colours[4 * ray] != second_fill || output.depths_m[ray] != second_fill) ++touched;
      }
    }
    return none_of(touched, outside, "rays outside an area of 11x7 written");
  }

  StageInfo info_;
  CheckOptions options_;
  BenchScene scene_;
  gpu::CommandList commands_;
  PictureSizePx size_ = usual_size;
  CastPipeline pipeline_;
  bool native_pipeline_made_ = false;
  NativeStage native_;
  std::unique_ptr<StageActivation> activation_;
  RayBuffers rays_;
  EyeTarget target_;
  HostRays host_rays_;
};

}  // namespace

std::unique_ptr<Subject> make_cast_subject(const StageInfo& stage, const CheckOptions& options) {
  if (options.device == nullptr)
    throw device_error("stage {} wants a Vulkan device to be checked", stage.id());
  return std::make_unique<CastSubject>(stage, options);
}

}  // namespace brace
