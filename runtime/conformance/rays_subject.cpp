// rays: the opening brace makes rays, the closing brace a picture.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "runtime/conformance/bench_scene.hpp"

namespace brace {

namespace {

struct BraceOutput {
  std::vector<std::uint32_t> rays;     // bits: 4 words of entries per ray, then 4 of directions
  std::vector<std::uint32_t> picture;  // image, then depth
  bool inputs_changed = false;
  std::uint64_t spoilt = 0;
};

struct BraceFaults {
  std::uint64_t rays = 0, pixels = 0, bad_rays = 0, bad_colours = 0, bad_depths = 0;
};

float as_float(std::uint32_t bits) {
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

BraceFaults judge(const BraceOutput& output, std::span<const int, 3> dims) {
  BraceFaults faults;
  faults.rays = output.rays.size() / 8;
  faults.pixels = output.picture.size() / 2;
  for (std::size_t ray = 0; ray < faults.rays; ++ray) {
    const std::uint32_t* entry = &output.rays[4 * ray];
    const std::uint32_t* direction = &output.rays[4 * (faults.rays + ray)];
    bool good = true;
    for (int i = 0; i < 4; ++i)
      good = good && std::isfinite(as_float(entry[i])) && std::isfinite(as_float(direction[i]));
    if (good && as_float(entry[3]) > 0.0f) {
      double length = 0.0;
      for (std::size_t i = 0; i < 3; ++i) {
        const float at = as_float(entry[i]);
        good = good && at >= -1e-3f && at <= static_cast<float>(dims[i]) + 1e-3f;
        length += std::abs(static_cast<double>(as_float(direction[i])));
      }
      good = good && length > 0.0;
    }
    if (!good) ++faults.bad_rays;
  }
  for (std::size_t pixel = 0; pixel < faults.pixels; ++pixel) {
    const std::uint32_t rgba = output.picture[pixel];
    const std::uint32_t opacity = rgba >> 24;
    if (std::max({rgba & 255u, (rgba >> 8) & 255u, (rgba >> 16) & 255u}) > opacity) ++faults.bad_colours;
    const float depth = as_float(output.picture[faults.pixels + pixel]);
    if (!(depth >= 0.0f)) ++faults.bad_depths;
  }
  return faults;
}

class RaysSubject final : public Subject {
 public:
  RaysSubject(const StageInfo& stage, const CheckOptions& options)
      : info_(stage), options_(options), scene_(*options.device), commands_(*options.device, "conformance") {}

  void make(const std::vector<double>& values) override {
    const PipelineStage stage{info_, values};
    std::vector<std::pair<std::string, std::string>> snippets = {{"cast", empty_cast_snippet}};
    if (is_native()) snippets.emplace_back("rays", plain_rays_snippet);
    if (!is_native() || !native_pipeline_made_) pipeline_ = bench_pipeline(options_, scene_, stage, snippets);
    native_pipeline_made_ = is_native();
    if (is_native()) {
      counted([&] { native_ = NativeStage(stage); });
    }
    rays_ = RayBuffers(*options_.device, size_.width, size_.height);
    target_ = EyeTarget(*options_.device, size_.width, size_.height);
    const auto pixels = static_cast<std::uint64_t>(size_.width) * static_cast<std::uint64_t>(size_.height);
    entries_ = GuardedBuffer(*options_.device, "entries", pixels * 16);
    directions_ = GuardedBuffer(*options_.device, "directions", pixels * 16);
    image_ = GuardedBuffer(*options_.device, "image", pixels * 4);
    depth_ = GuardedBuffer(*options_.device, "depth", pixels * 4);
  }

  void activate() override {
    if (!is_native()) return;
    counted([&] {
      activation_ = std::make_unique<StageActivation>(
          activation_input(*options_.device, scene_.volume, scene_.placement, scene_.table,
                           BenchScene::step_units, size_.width, size_.height));
      native_.activate(activation_->get());
    });
  }

  Trial use() override {
    Trial trial;
    for (const BenchView view : bench_views) {
      const BraceOutput output = run(view, second_fill);
      append(trial.outputs, output.rays.data(), output.rays.size());
      append(trial.outputs, output.picture.data(), output.picture.size());
      const BraceFaults faults = judge(output, dims());
      if (faults.bad_rays + faults.bad_colours + faults.bad_depths != 0)
        trial.violation = "rays or pixels break the contract";
      trial.values += faults.rays;
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
  bool runs_on_host() const override { return false; }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    suite.clause("sizes from 1x1 to odd to large", [&] { return check_sizes(values); });
    BraceFaults faults;
    std::uint64_t unwritten = 0, spoilt = 0;
    bool changed = false;
    suite.prepare("opens and closes from outside, inside and past the volume", [&] {
      const Life life(*this, values);
      for (const BenchView view : bench_views) {
        const BraceOutput a = run(view, first_fill), b = run(view, second_fill);
        const BraceFaults found = judge(b, dims());
        faults.rays += found.rays, faults.pixels += found.pixels;
        faults.bad_rays += found.bad_rays, faults.bad_colours += found.bad_colours;
        faults.bad_depths += found.bad_depths;
        unwritten += count_unwritten(a.rays, b.rays) + count_unwritten(a.picture, b.picture);
        changed = changed || a.inputs_changed || b.inputs_changed;
        spoilt += a.spoilt + b.spoilt;
      }
    });
    suite.clause("every ray and pixel is written", [&] {
      return none_of(unwritten, 8 * faults.rays + 2 * faults.pixels, "words were left as they were");
    });
    suite.clause("rays are finite and enter inside the box",
                 [&] { return none_of(faults.bad_rays, faults.rays, "rays"); });
    suite.clause("colours within [0, opacity]",
                 [&] { return none_of(faults.bad_colours, faults.pixels, "pixels outside"); });
    suite.clause("depths are distances", [&] { return none_of(faults.bad_depths, faults.pixels, "pixels"); });
    suite.clause("inputs are left alone", [&] {
      if (changed) throw Broken("results or parameters were overwritten");
      return std::string("results and parameters unchanged");
    });
    suite.clause("nothing behind the buffers",
                 [&] { return none_of(spoilt, watchdog_guard_bytes, "guard words overwritten"); });
  }

 private:
  std::span<const int, 3> dims() const { return scene_.host_volume.info.dims; }

  static std::uint64_t count_unwritten(const std::vector<std::uint32_t>& a,
                                       const std::vector<std::uint32_t>& b) {
    std::uint64_t words = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      words += a[i] == first_fill && b[i] == second_fill ? 1u : 0u;
    return words;
  }

  void read_to(std::vector<std::uint32_t>& words, const std::vector<std::byte>& bytes) {
    const std::size_t at = words.size();
    words.resize(at + bytes.size() / 4);
    std::memcpy(words.data() + at, bytes.data(), bytes.size());
  }

  /// Results as a cast stage could have left them: all opacities, some rays without a hit.
  void write_results() {
    const auto rays = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
    std::vector<float> colours(4 * rays), depths(rays);
    for (std::size_t ray = 0; ray < rays; ++ray) {
      const float opacity = ray % 3 == 0 ? 0.0f : static_cast<float>(ray % 11) / 10.0f;
      for (std::size_t c = 0; c < 3; ++c)
        colours[4 * ray + c] = opacity * static_cast<float>((ray + c) % 5) / 4.0f;
      colours[4 * ray + 3] = opacity;
      depths[ray] = opacity > 0.0f ? 0.5f + 0.001f * static_cast<float>(ray % 100) : INFINITY;
    }
    gpu::upload_values(*options_.device, rays_.colours, std::span<const float>(colours));
    gpu::upload_values(*options_.device, rays_.depths_m, std::span<const float>(depths));
  }

  std::vector<std::byte> closing_inputs() const {
    std::vector<std::byte> all;
    for (const gpu::Buffer* buffer : {&rays_.colours, &rays_.depths_m, &target_.params}) {
      std::vector<std::byte> bytes(buffer->size_bytes());
      gpu::download(*options_.device, *buffer, bytes);
      append(all, bytes.data(), bytes.size());
    }
    return all;
  }

  BraceOutput run(BenchView view, std::uint32_t before) {
    const gpu::Device& device = *options_.device;
    const EyeView eye = bench_eye(view, size_);
    const CastArea whole{0, 0, size_.width, size_.height};
    CastPipeline::set_eye(device, target_, eye, scene_.placement, scene_.volume, scene_.transfer);
    for (const GuardedBuffer* buffer : {&entries_, &directions_, &image_, &depth_})
      buffer->fill(device, before);
    write_results();
    const std::vector<std::byte> inputs_before = closing_inputs();

    const CastPipeline::Resources resources{scene_.volume, scene_.transfer, rays_, target_};
    const EyeCast one{device, pipeline_, resources, eye};
    commands_.reset();
    commands_.barrier();
    if (is_native()) {
      brace_cast_frame frame = cast_frame(one, commands_.hand_out(), whole);
      frame.ray_entries = entries_.range();
      frame.ray_directions = directions_.range();
      frame.eye_image = image_.range();
      frame.eye_depth_m = depth_.range();
      native_.open(frame);
      commands_.barrier();
      native_.close(frame);
    } else {
      pipeline_.record_opening(commands_, resources, whole);
      commands_.barrier();
      pipeline_.record_closing(commands_, resources, whole);
      commands_.barrier();
      const std::uint64_t pixels = entries_.size_bytes() / 16;
      commands_.copy(rays_.entries, entries_.buffer(), pixels * 16);
      commands_.copy(rays_.directions, directions_.buffer(), pixels * 16);
      commands_.copy(target_.image, image_.buffer(), pixels * 4);
      commands_.copy(target_.depth, depth_.buffer(), pixels * 4);
    }
    commands_.barrier();
    (void)gpu::submit_and_wait(commands_);

    BraceOutput output;
    output.inputs_changed = closing_inputs() != inputs_before;
    read_to(output.rays, entries_.read(device));
    read_to(output.rays, directions_.read(device));
    read_to(output.picture, image_.read(device));
    read_to(output.picture, depth_.read(device));
    for (const GuardedBuffer* buffer : {&entries_, &directions_, &image_, &depth_})
      output.spoilt += buffer->spoilt(device);
    return output;
  }

  std::string check_sizes(const std::vector<double>& values) {
    std::string sizes;
    for (const PictureSizePx size : bench_sizes(options_)) {
      size_ = size;
      try {
        const Life life(*this, values);
        (void)run(BenchView::outside, first_fill);
      } catch (const std::runtime_error& failed) {
        size_ = usual_size;
        throw Broken(fmt::format("{}x{}: {}", size.width, size.height, failed.what()));
      }
      sizes += fmt::format("{}{}x{}", sizes.empty() ? "" : ", ", size.width, size.height);
    }
    size_ = usual_size;
    return sizes;
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
  GuardedBuffer entries_, directions_, image_, depth_;
};

}  // namespace

std::unique_ptr<Subject> make_rays_subject(const StageInfo& stage, const CheckOptions& options) {
  if (options.device == nullptr)
    throw device_error("stage {} wants a Vulkan device to be checked", stage.id());
  return std::make_unique<RaysSubject>(stage, options);
}

}  // namespace brace
