#include "bench/host.hpp"

#include <algorithm>
#include <chrono>
#include <functional>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "runtime/host/allocation_count.hpp"
#include "runtime/raycast/native_steps.hpp"

namespace brace {

namespace {

constexpr int kBatch = 500;  // frames timed together: a clock's own cost disappears

// Stages that do nothing. They are reached as a library's are: through descriptors and tables.
int object = 0;
void* create(const double*, std::uint32_t) {
  return &object;
}
void destroy(void*) {}
brace_result on_frame(void*, const brace_cast_frame*) {
  return BRACE_OK;
}
brace_result on_stereo(void*, const brace_stereo_frame*) {
  return BRACE_OK;
}
brace_result on_warp(void*, const brace_warp_frame*) {
  return BRACE_OK;
}
brace_result on_predict(void*, const brace_tracker_sample* history, std::uint32_t count, std::int64_t,
                        brace_pose* pose) {
  *pose = history[count - 1].world_from_head;
  return BRACE_OK;
}
brace_result on_control(void*, const brace_control_input*, double* quality) {
  *quality = 1.0;
  return BRACE_OK;
}

const brace_rays_functions rays_functions{sizeof rays_functions, on_frame, on_frame};
const brace_cast_functions cast_functions{sizeof cast_functions, on_frame, nullptr, 0};
const brace_stereo_functions stereo_functions{sizeof stereo_functions, on_stereo};
const brace_warp_functions warp_functions{sizeof warp_functions, on_warp};
const brace_predict_functions predict_functions{sizeof predict_functions, on_predict};
const brace_control_functions control_functions{sizeof control_functions, on_control};

NativeStage make_stage(brace_kind kind, const void* functions) {
  // The host keeps a pointer to the descriptor as long as the stage lives.
  static brace_stage_descriptor descriptors[BRACE_KIND_COST + 1];
  brace_stage_descriptor& descriptor = descriptors[kind];
  descriptor = {};
  descriptor.struct_size = sizeof descriptor;
  descriptor.kind = kind;
  descriptor.name = "nothing";
  descriptor.version = "1.0.0";
  descriptor.help = "does nothing";
  descriptor.create = create;
  descriptor.destroy = destroy;
  descriptor.functions = functions;
  NativeStage stage(PipelineStage{stage_info(descriptor, ""), {}});
  stage.activate();
  return stage;
}

HostBenchCase measure(const std::string& name, double calls, int frames, const std::function<void()>& frame) {
  std::vector<double> ns;
  ns.reserve(static_cast<std::size_t>(frames / kBatch + 1));
  for (int i = 0; i < kBatch; ++i)
    frame();  // warm
  const std::uint64_t allocations = allocations_of_this_thread().allocations;
  for (int batch = 0; batch < std::max(1, frames / kBatch); ++batch) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kBatch; ++i)
      frame();
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - begin;
    ns.push_back(taken.count() / kBatch);
  }
  const std::uint64_t taken = allocations_of_this_thread().allocations - allocations;
  std::sort(ns.begin(), ns.end());
  const auto batches = static_cast<double>(ns.size());
  return {name, calls, ns[ns.size() / 2], ns[ns.size() * 95 / 100],
          static_cast<double>(taken) / (batches * kBatch)};
}

/// Everything a frame's structs point to.
struct Scene {
  explicit Scene(const gpu::Device& device)
      : volume(device, *open_volume("generator:solid_box:8")),
        table{{0.0, 255.0}, std::vector<std::array<double, 4>>(256)},
        transfer(device, table, 0.5),
        rays(device, 64, 64),
        target(device, 64, 64),
        pipeline(device, CastKernels{}) {
    view.width_px = view.height_px = 64;
  }
  VolumeOnDevice volume;
  TransferTable table;
  TransferOnDevice transfer;
  RayBuffers rays;
  EyeTarget target;
  CastPipeline pipeline;
  EyeView view;
};

}  // namespace

HostBenchResult bench_host(const HostBenchOptions& options) {
  BRACE_CHECK(options.device != nullptr && options.frames > 0);
  const gpu::Device& device = *options.device;
  const Scene scene(device);
  const CastPipeline::Resources resources{scene.volume, scene.transfer, scene.rays, scene.target};
  EyeCast eye{device, scene.pipeline, resources, scene.view};
  const CastArea area{0, 0, 64, 64};

  const NativeStage rays = make_stage(BRACE_KIND_RAYS, &rays_functions);
  const NativeStage cast = make_stage(BRACE_KIND_CAST, &cast_functions);
  const NativeStage warp = make_stage(BRACE_KIND_WARP, &warp_functions);
  const NativeStage stereo = make_stage(BRACE_KIND_STEREO, &stereo_functions);
  const NativeStage predict = make_stage(BRACE_KIND_PREDICT, &predict_functions);
  const NativeStage control = make_stage(BRACE_KIND_CONTROL, &control_functions);

  const auto both_eyes = [&](const auto& step) {
    for (const std::uint32_t which : {0u, 1u}) {
      eye.eye = which;
      step();
    }
    ++eye.frame;
  };
  const auto open = [&] { rays.open(cast_frame(eye, nullptr, area)); };
  const auto close = [&] { rays.close(cast_frame(eye, nullptr, area)); };
  const auto do_cast = [&] { cast.cast(cast_frame(eye, nullptr, area)); };
  const auto do_warp = [&] {
    brace_warp_frame frame{};
    frame.struct_size = sizeof frame;
    frame.eye = eye.eye;
    frame.world_from_eye = to_abi(scene.view.world_from_eye);
    frame.eye_image = buffer_range(scene.target.image);
    frame.eye_depth_m = buffer_range(scene.target.depth);
    frame.warped_image = buffer_range(scene.target.image);
    warp.warp(frame);
  };
  const auto do_stereo = [&] {
    brace_stereo_frame frame{};
    frame.struct_size = sizeof frame;
    frame.left_image = frame.right_image = buffer_range(scene.target.image);
    frame.left_depth_m = frame.right_depth_m = buffer_range(scene.target.depth);
    frame.left_params = frame.right_params = buffer_range(scene.target.params);
    stereo.stereo(frame);
  };
  const auto decide = [&] {
    const brace_tracker_sample newest{};
    brace_pose pose{};
    double quality = 1.0;
    const brace_control_input input{sizeof input, eye.frame, 1, 1, 0, 1};
    (void)predict.predict_functions().predict(predict.self(), &newest, 1, 0, &pose);
    (void)predict.predict_functions().predict(predict.self(), &newest, 1, 0, &pose);
    (void)control.control_functions().update(control.self(), &input, &quality);
  };

  HostBenchResult result{device.info().name, options.frames, {}, bench_start(device, options.data_folder)};
  const auto add = [&](const char* name, double calls, const std::function<void()>& frame) {
    result.cases.push_back(measure(name, calls, options.frames, frame));
  };
  add("rays", 4, [&] { both_eyes([&] { open(), close(); }); });
  add("cast", 2, [&] { both_eyes(do_cast); });
  add("stereo", 1, do_stereo);
  add("warp", 2, [&] { both_eyes(do_warp); });
  add("predict, control", 3, decide);
  add("whole frame", 12, [&] {
    decide();
    both_eyes([&] { open(), do_cast(), close(), do_warp(); });
    do_stereo();
  });
  return result;
}

std::string to_text(const HostBenchResult& result) {
  std::string text = fmt::format(
      "stages behind the C interface: the host's own time per frame of both eyes, {} frames, stages that do\n"
      "nothing\n\n{:<18}{:>8}{:>12}{:>12}{:>14}\n",
      result.frames, "stages", "calls", "ns median", "ns p95", "allocations");
  for (const HostBenchCase& c : result.cases) {
    text += fmt::format("{:<18}{:>8.0f}{:>12.1f}{:>12.1f}{:>14.3f}\n", c.name, c.calls, c.ns_per_frame,
                        c.ns_p95, c.allocations_per_frame);
  }
  const HostBenchCase& whole = result.cases.back();
  text += fmt::format("\ntarget: {:.0f} ns per frame and no allocation; ratio {:.1f}\n",
                      host_overhead_target_ns, host_overhead_target_ns / whole.ns_per_frame);
  text += fmt::format(
      "start to first frame on {}: cold {:.3f} s (target {:.1f}), warm {:.3f} s (target {:.1f})\n",
      result.device, result.start.cold_s, cold_start_target_s, result.start.warm_s, warm_start_target_s);
  return text;
}

std::string to_json(const HostBenchResult& result) {
  nlohmann::json cases = nlohmann::json::array();
  for (const HostBenchCase& c : result.cases) {
    cases.push_back({{"stages", c.name},
                     {"calls", c.calls},
                     {"ns_per_frame", c.ns_per_frame},
                     {"ns_p95", c.ns_p95},
                     {"allocations_per_frame", c.allocations_per_frame}});
  }
  const nlohmann::json json{{"bench", "host"},
                            {"device", result.device},
                            {"frames", result.frames},
                            {"target_ns_per_frame", host_overhead_target_ns},
                            {"cases", cases},
                            {"start",
                             {{"cold_s", result.start.cold_s},
                              {"warm_s", result.start.warm_s},
                              {"target_cold_s", cold_start_target_s},
                              {"target_warm_s", warm_start_target_s}}}};
  return json.dump(2) + "\n";
}

}  // namespace brace
