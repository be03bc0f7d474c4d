// stereo and warp: from one picture to another.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.hpp"
#include "runtime/conformance/bench_scene.hpp"
#include "runtime/display/display_pipeline.hpp"

namespace brace {

namespace {

struct PictureOutput {
  std::vector<std::byte> image, depth;  // depth is empty for warps
  bool inputs_changed = false;
  std::uint64_t spoilt = 0;
};

brace_eye_view abi_view(const EyeView& view) {
  return {to_abi(view.world_from_eye),
          view.tan_left,
          view.tan_right,
          view.tan_bottom,
          view.tan_top,
          static_cast<std::uint32_t>(view.width_px),
          static_cast<std::uint32_t>(view.height_px)};
}

class NativePictureSubject final : public Subject {
 public:
  NativePictureSubject(const StageInfo& stage, const CheckOptions& options)
      : info_(stage), options_(options), scene_(*options.device), commands_(*options.device, "conformance") {}

  void make(const std::vector<double>& values) override {
    counted([&] { stage_ = NativeStage({info_, values}); });
    const gpu::Device& device = *options_.device;
    const auto bytes = static_cast<std::uint64_t>(size_.width) * static_cast<std::uint64_t>(size_.height) * 4;
    for (GuardedBuffer* buffer : {&in_image_, &in_depth_, &out_image_, &out_depth_}) {
      if (buffer->size_bytes() != bytes) *buffer = GuardedBuffer(device, "picture", bytes);
    }
    for (EyeTarget* target : {&left_, &right_}) {
      if (target->width_px != size_.width || target->height_px != size_.height) {
        *target = EyeTarget(device, size_.width, size_.height);
      }
    }
  }

  void activate() override {
    counted([&] {
      activation_ = std::make_unique<StageActivation>(
          activation_input(*options_.device, scene_.volume, scene_.placement, scene_.table,
                           BenchScene::step_units, size_.width, size_.height));
      stage_.activate(activation_->get());
    });
  }

  Trial use() override {
    Trial trial;
    for (const BenchView view : bench_views) {
      const PictureOutput output = run(view, second_fill);
      append(trial.outputs, output.image.data(), output.image.size());
      append(trial.outputs, output.depth.data(), output.depth.size());
      trial.values += output.image.size() / 4;
      if (bad_colours(output) + bad_depths(output) != 0) trial.violation = "pixels break the contract";
    }
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
  bool runs_on_host() const override { return false; }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    suite.clause("sizes from 1x1 to odd to large", [&] { return check_sizes(values); });
    std::uint64_t pixels = 0, colours = 0, depths = 0, kept = 0, spoilt = 0;
    bool changed = false;
    suite.prepare("makes pictures", [&] {
      const Life life(*this, values);
      for (const BenchView view : bench_views) {
        const PictureOutput a = run(view, first_fill), b = run(view, second_fill);
        pixels += a.image.size() / 4;
        colours += bad_colours(b);
        depths += bad_depths(b);
        kept += count_kept(a.image, b.image) + count_kept(a.depth, b.depth);
        changed = changed || a.inputs_changed || b.inputs_changed;
        spoilt += a.spoilt + b.spoilt;
      }
    });
    suite.clause("every pixel is written",
                 [&] { return none_of(kept, pixels, "pixels were left as they were"); });
    suite.clause("colours within [0, opacity]", [&] { return none_of(colours, pixels, "pixels outside"); });
    if (info_.family == "stereo") {
      suite.clause("depths are distances", [&] { return none_of(depths, pixels, "pixels"); });
    }
    suite.clause("inputs are left alone", [&] {
      if (changed) throw Broken("the finished picture was overwritten");
      return std::string("the finished picture is unchanged");
    });
    suite.clause("nothing behind the buffers",
                 [&] { return none_of(spoilt, watchdog_guard_bytes, "guard words overwritten"); });
  }

 private:
  static std::uint64_t count_kept(const std::vector<std::byte>& a, const std::vector<std::byte>& b) {
    std::uint64_t kept = 0;
    for (std::size_t i = 0; i < a.size(); i += 4) {
      std::uint32_t first = 0, second = 0;
      std::memcpy(&first, &a[i], 4);
      std::memcpy(&second, &b[i], 4);
      kept += first == first_fill && second == second_fill ? 1u : 0u;
    }
    return kept;
  }

  static std::uint64_t bad_colours(const PictureOutput& output) {
    std::uint64_t bad = 0;
    for (std::size_t i = 0; i < output.image.size(); i += 4) {
      const auto* rgba = reinterpret_cast<const std::uint8_t*>(&output.image[i]);
      bad += std::max({rgba[0], rgba[1], rgba[2]}) > rgba[3] ? 1u : 0u;
    }
    return bad;
  }

  static std::uint64_t bad_depths(const PictureOutput& output) {
    std::uint64_t bad = 0;
    for (std::size_t i = 0; i < output.depth.size(); i += 4) {
      float depth = 0.0f;
      std::memcpy(&depth, &output.depth[i], 4);
      bad += depth >= 0.0f ? 0u : 1u;
    }
    return bad;
  }

  /// A finished eye frame: all opacities, depths with jumps and pixels without a hit.
  void write_inputs() {
    std::vector<std::byte> image, depth;
    for (std::size_t i = 0; i < in_image_.size_bytes() / 4; ++i) {
      const auto opacity = static_cast<std::uint32_t>(i % 4 == 0 ? 0 : (i * 37) % 256);
      const std::uint32_t rgba = (opacity << 24) | ((opacity / 2) << 16) | ((opacity / 3) << 8) | opacity;
      const float distance = opacity == 0 ? INFINITY : 0.4f + 0.01f * static_cast<float>(i % 50);
      append(image, &rgba, 1);
      append(depth, &distance, 1);
    }
    in_image_.write(*options_.device, image);
    in_depth_.write(*options_.device, depth);
  }

  brace_result record_stereo(const EyeView& eye) {
    EyeView other = eye;
    other.world_from_eye.position.x += 0.064;
    CastPipeline::set_eye(*options_.device, left_, eye, scene_.placement, scene_.volume, scene_.transfer);
    CastPipeline::set_eye(*options_.device, right_, other, scene_.placement, scene_.volume, scene_.transfer);
    brace_stereo_frame frame{};
    frame.struct_size = sizeof frame;
    frame.commands = commands_.hand_out();
    frame.left = abi_view(eye);
    frame.right = abi_view(other);
    frame.left_params = buffer_range(left_.params);
    frame.right_params = buffer_range(right_.params);
    frame.left_image = in_image_.range();
    frame.left_depth_m = in_depth_.range();
    frame.right_image = out_image_.range();
    frame.right_depth_m = out_depth_.range();
    stage_.stereo(frame);
    return BRACE_OK;
  }

  void record_warp(const EyeView& eye) {
    Pose now = eye.world_from_eye;
    now.orientation = now.orientation * quat_exp({0.02, -0.03, 0.01});
    now.position.x += 0.01;
    brace_warp_frame frame{};
    frame.struct_size = sizeof frame;
    frame.commands = commands_.hand_out();
    frame.rendered = abi_view(eye);
    frame.world_from_eye = to_abi(now);
    frame.eye_image = in_image_.range();
    frame.eye_depth_m = in_depth_.range();
    frame.warped_image = out_image_.range();
    stage_.warp(frame);
  }

  PictureOutput run(BenchView view, std::uint32_t before) {
    const gpu::Device& device = *options_.device;
    const EyeView eye = bench_eye(view, size_);
    const bool is_stereo = info_.family == "stereo";
    write_inputs();
    out_image_.fill(device, before);
    out_depth_.fill(device, before);
    const std::vector<std::byte> image = in_image_.read(device), depth = in_depth_.read(device);
    commands_.reset();
    commands_.barrier();
    if (is_stereo) {
      record_stereo(eye);
    } else {
      record_warp(eye);
    }
    commands_.barrier();
    (void)gpu::submit_and_wait(commands_);
    PictureOutput output;
    output.image = out_image_.read(device);
    if (is_stereo) output.depth = out_depth_.read(device);
    output.inputs_changed = in_image_.read(device) != image || in_depth_.read(device) != depth;
    for (const GuardedBuffer* buffer : {&in_image_, &in_depth_, &out_image_, &out_depth_}) {
      output.spoilt += buffer->spoilt(device);
    }
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
  NativeStage stage_;
  std::unique_ptr<StageActivation> activation_;
  GuardedBuffer in_image_, in_depth_, out_image_, out_depth_;
  EyeTarget left_, right_;
};

/// A warp as a GLSL function, on a panel without a lens.
class GlslWarpSubject final : public Subject {
 public:
  GlslWarpSubject(const StageInfo& stage, const CheckOptions& options)
      : info_(stage), options_(options), commands_(*options.device, "conformance") {}

  void make(const std::vector<double>& values) override {
    const gpu::Device& device = *options_.device;
    const PipelineStage stage{info_, values};
    const PipelineStage* const chosen[] = {&stage};
    StageGlsl glsl = stage_glsl(chosen);
    DisplayParts parts;
    parts.glsl_folder = options_.data_folder / "glsl";
    parts.kernels_folder = options_.data_folder / "kernels";
    parts.stages = std::move(glsl.resolve);
    parts.constants = std::move(glsl.constants);
    parts.lens.kind = sim::LensKind::identity;
    parts.lens.one_centre = parts.lens.one_fetch = true;
    const gpu::KernelDescription kernel = compose_display_kernel(parts);
    for (const auto& binding : gpu::reflect(gpu::compile(kernel).spirv, kernel.main.name).bindings) {
      if (binding.slot < DisplaySlot::first_of_warp) continue;
      throw input_error("{}: stage {} binds '{}' to slot {}; accepted: slots 0 to {}, which the host fills",
                        info_.origin.string(), info_.id(), binding.name, binding.slot,
                        DisplaySlot::first_of_warp - 1);
    }
    pipeline_ = DisplayPipeline(device, kernel);
    sim::FovTangents fov;
    fov.left = fov.bottom = -0.8;
    fov.right = fov.top = 0.8;
    panel_ = PanelTarget(device, {size_.width, size_.height, sim::identity_lens(fov), fov},
                         {size_.width, size_.height, fov});
    const auto pixels = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
    std::vector<std::uint32_t> picture(pixels);
    for (std::size_t i = 0; i < pixels; ++i)
      picture[i] = 0xff000000u | static_cast<std::uint32_t>(i * 2654435761u >> 8);
    source_ = gpu::Buffer(device, "source", pixels * 4, gpu::Memory::device);
    gpu::upload_values(device, source_, std::span<const std::uint32_t>(picture));
    texels_ = gpu::TexelBuffer(device, source_, gpu::Format::r32_uint);
    // Near, far and nothing.
    std::vector<float> depths_m(pixels);
    for (std::size_t i = 0; i < pixels; ++i)
      depths_m[i] = i % 3 == 0 ? std::numeric_limits<float>::infinity() : i % 3 == 1 ? 0.5f : 3.0f;
    depth_ = gpu::Buffer(device, "depth", pixels * 4, gpu::Memory::device);
    gpu::upload_values(device, depth_, std::span<const float>(depths_m));
    depth_texels_ = gpu::TexelBuffer(device, depth_, gpu::Format::r32_float);
  }
  void activate() override {}
  void deactivate() override {}
  void unmake() override {}
  bool is_native() const override { return false; }
  bool runs_on_host() const override { return false; }

  Trial use() override {
    Trial trial;
    for (const double turn_rad : {0.0, 0.05, 3.141592653589793}) {
      Pose now{quat_exp({0.3 * turn_rad, turn_rad, 0.0}), {0.1 * turn_rad, 0.0, 0.0}};
      panel_.set_poses(*options_.device, Pose{}, now);
      commands_.reset();
      const gpu::Binding depth = gpu::bind(DisplaySlot::source_depth, depth_texels_);
      pipeline_.record(commands_, panel_, texels_, std::span(&depth, pipeline_.uses_depth() ? 1 : 0));
      commands_.barrier();
      (void)gpu::submit_and_wait(commands_);
      const ImageRgba8 image = panel_.read(*options_.device);
      append(trial.outputs, image.pixels.data(), image.pixels.size());
      trial.values += image.pixels.size();
    }
    return trial;
  }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    suite.clause("sizes from 2x2 to odd to large", [&] {
      std::string sizes;
      make(values);
      const bool shows_as_is = differing_channels() == 0;  // at the usual size; else another clause says so
      for (const PictureSizePx size : {PictureSizePx{2, 2}, {7, 5}, {33, 17}, {129, 65}}) {
        size_ = size;
        make(values);
        const std::string name = fmt::format("{}x{}", size.width, size.height);
        if (differing_channels() > 0 && shows_as_is)
          throw Broken(name + ": equal poses do not show the picture as it is");
        sizes += (sizes.empty() ? "" : ", ") + name;
      }
      size_ = usual_size;
      return sizes;
    });
    size_ = usual_size;  // also after a size that failed
    suite.clause("equal poses show the picture as it is", [&] {
      make(values);
      return none_of(differing_channels(), source_.size_bytes(), "channels differ by more than 2/255");
    });
  }

 private:
  /// Channels of the picture shown that are not those of the eye frame, at equal poses.
  std::uint64_t differing_channels() {
    const Trial trial = use();
    std::vector<std::byte> picture(source_.size_bytes());
    gpu::download(*options_.device, source_, picture);
    std::uint64_t differing = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
      const int difference = std::to_integer<int>(picture[i]) - std::to_integer<int>(trial.outputs[i]);
      differing += std::abs(difference) > 2 ? 1u : 0u;
    }
    return differing;
  }

  StageInfo info_;
  CheckOptions options_;
  gpu::CommandList commands_;
  PictureSizePx size_ = usual_size;
  DisplayPipeline pipeline_;
  PanelTarget panel_;
  gpu::Buffer source_, depth_;
  gpu::TexelBuffer texels_, depth_texels_;
};

}  // namespace

std::unique_ptr<Subject> make_picture_subject(const StageInfo& stage, const CheckOptions& options) {
  if (options.device == nullptr)
    throw device_error("stage {} wants a Vulkan device to be checked", stage.id());
  if (stage.native != nullptr) return std::make_unique<NativePictureSubject>(stage, options);
  if (stage.family == "warp") return std::make_unique<GlslWarpSubject>(stage, options);
  throw input_error(
      "{}: stage {} is a snippet that only its own kernels can show; accepted: native stereo stages",
      stage.origin.string(), stage.id());
}

}  // namespace brace
