#include "bench/costs.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <stdlib.h>

#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/panel_display.hpp"

namespace brace {

namespace {

struct Case {
  const char* volume;
  const char* transfer_function;
  const char* shading;
  const char* skip;
  double resolution_scale;
};

// Each coefficient has cases with much and with little of what it prices.
constexpr Case kCases[] = {
    {"marschner_lobb:96", "tf2", "none", "none", 0.05},
    {"marschner_lobb:96", "tf2", "none", "none", 0.2},
    {"nested_shells:128", "tf3", "none", "none", 0.1},
    {"nested_shells:128", "tf3", "phong", "none", 0.1},
    {"marschner_lobb:96", "tf2", "phong", "none", 0.1},
    {"marschner_lobb:96", "tf3", "phong", "none", 0.2},
    {"fractal_vessels:128", "tf1", "none", "none", 0.2},
    {"fractal_vessels:128", "tf1", "none", "distance_map", 0.1},
    {"fractal_vessels:128", "tf1", "none", "distance_map", 0.3},
    {"fractal_vessels:128", "tf3", "phong", "distance_map", 0.3},
    {"solid_box:32", "tf3", "none", "none", 0.02},
    {"solid_box:32", "tf3", "none", "none", 0.4},
};

std::string session_text(const Case& c) {
  return fmt::format(
      "device.resolution_scale = {}\ntrace.neck = {{ motion = 'still' }}\npipeline.skip = '{}'\n"
      "[scene]\nvolume = 'generator:{}'\ntransfer_function = '{}'\nshading = '{}'\nposition = 'front:0.8'\n",
      c.resolution_scale, c.skip, c.volume, c.transfer_function, c.shading);
}

template <typename Job>
CostSample best_of(JobKind kind, int repetitions, const Job& job) {
  job();  // warm up: kernels are compiled at their first use
  CostSample best{kind, {}, SimDuration::max()};
  for (int i = 0; i < repetitions; ++i) {
    const JobOutcome outcome = job();
    best.work = outcome.work;
    best.time = std::min(best.time, outcome.device_time);
  }
  return best;
}

void measure(const gpu::Device& device, const CostBenchOptions& options, const Case& c,
             std::vector<CostSample>& samples) {
  const Session session = parse_session(session_text(c), "bench", ".", {}, options.stages);
  const ReplayOptions replay{.data_folder = options.data_folder};
  const Headset headset = make_headset(session, options.data_folder);
  const Pose head{};
  const VolumePlacement placement = place_volume(session.scene, head);
  const std::unique_ptr<SceneOnDevice> scene = load_scene(device, session, replay, headset, placement);
  EyeRenderer renderer(device, session, headset, *scene, placement, options.data_folder,
                       EyeRenderer::Counting::on);
  PanelDisplay display(device, headset, session.pipeline.at("warp"), options.data_folder);
  const EyePair eyes = make_eye_pair(device, headset.eye);
  samples.push_back(best_of(JobKind::cast, options.repetitions, [&] { return renderer.render(head, eyes); }));
  samples.push_back(best_of(JobKind::warp, options.repetitions, [&] {
    return display.show({eyes, head, head});
  }));
}

std::string lower_case_name(const std::string& device) {
  std::string name;
  for (const char c : device) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) name += c;
    if (c >= 'A' && c <= 'Z') name += static_cast<char>(c - 'A' + 'a');
    if (c == ' ' && !name.empty() && name.back() != '-') name += '-';
  }
  return name;
}

}  // namespace

CostBenchResult bench_costs(const CostBenchOptions& options) {
  CostBenchResult result;
  getloadavg(&result.host_load, 1);
  const gpu::Device device(options.device);
  result.device = device.info().name;
  result.driver = device.info().driver;
  for (const Case& c : kCases)
    measure(device, options, c, result.samples);
  result.fit = fit_cost_model(result.samples, lower_case_name(result.device));
  return result;
}

std::string to_text(const CostBenchResult& result) {
  std::string unobserved;
  for (const std::string& name : result.fit.unobserved)
    unobserved += (unobserved.empty() ? "" : ", ") + name;
  return fmt::format(
      "# Fitted by `brace bench costs` on {} ({}): non-negative least squares on the relative\n"
      "# errors of {} casts and warps, each the least of its repetitions; error {:.1f} % rms, {:.1f} % at "
      "most.\n"
      "# Load average of the host at the begin: {:.1f}. Not told by any measurement, hence 0: {}.\n{}",
      result.device, result.driver, result.samples.size(), 100.0 * result.fit.rms_relative_error,
      100.0 * result.fit.max_relative_error, result.host_load, unobserved.empty() ? "nothing" : unobserved,
      to_toml(result.fit.model));
}

std::string to_json(const CostBenchResult& result) {
  nlohmann::ordered_json jobs = nlohmann::ordered_json::array();
  for (const CostSample& s : result.samples) {
    jobs.push_back({{"kind", name_of(s.kind)},
                    {"rays", s.work.rays},
                    {"samples", s.work.samples},
                    {"skip_steps", s.work.skip_steps},
                    {"shading_fetches", s.work.shading_fetches},
                    {"texels", s.work.texels},
                    {"measured_ns", to_ns(s.time)},
                    {"model_ns", to_ns(evaluate(result.fit.model, s.kind, s.work))}});
  }
  const nlohmann::ordered_json json = {{"device", result.device},
                                       {"driver", result.driver},
                                       {"host_load", result.host_load},
                                       {"rms_relative_error", result.fit.rms_relative_error},
                                       {"max_relative_error", result.fit.max_relative_error},
                                       {"jobs", jobs},
                                       {"model", to_toml(result.fit.model)}};
  return json.dump(2);
}

}  // namespace brace
