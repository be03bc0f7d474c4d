#include "bench/integrators.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "bench/median.hpp"
#include "runtime/verify/caster.hpp"
#include "runtime/volume/generators.hpp"
#include "runtime/volume/statistics.hpp"

namespace brace {

namespace {

constexpr double kTargetError = 1e-3;  // RMS
constexpr double kTermination = 0.9999;

struct Scene {
  std::string name;
  const Volume* volume;
  TransferTable table;
  std::vector<CastRay> rays;
};

/// Parallel rays on a grid, oblique to all axes, in units of the smallest spacing.
std::vector<CastRay> grid_of_rays(const VolumeInfo& info, int edge) {
  const double unit = voxel_length(info);
  const glm::dvec3 spacing = glm::dvec3(info.spacing[0], info.spacing[1], info.spacing[2]) / unit;
  const glm::dvec3 dims(info.dims[0], info.dims[1], info.dims[2]);
  const glm::dvec3 along = glm::normalize(glm::dvec3(0.31, 0.24, -0.92));
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), along));
  const glm::dvec3 up = glm::cross(along, right);
  const glm::dvec3 centre = 0.5 * dims * spacing;
  const double reach = 0.5 * std::max({dims.x * spacing.x, dims.y * spacing.y, dims.z * spacing.z});
  std::vector<CastRay> rays;
  for (int j = 0; j < edge; ++j) {
    for (int i = 0; i < edge; ++i) {
      const glm::dvec3 at =
          centre + reach * ((2.0 * i + 1) / edge - 1) * right + reach * ((2.0 * j + 1) / edge - 1) * up;
      double begin = -1e9, end = 1e9;
      for (int axis = 0; axis < 3; ++axis) {
        const double a = -at[axis] / along[axis], b = (dims[axis] * spacing[axis] - at[axis]) / along[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
      }
      if (end - begin < 1) continue;
      const glm::dvec3 entry = glm::clamp((at + begin * along) / spacing, glm::dvec3(0.0), dims);
      rays.push_back({glm::vec4(glm::vec3(entry), static_cast<float>(end - begin)),
                      glm::vec4(glm::vec3(along / spacing), 0.0f)});
    }
  }
  return rays;
}

TransferTable table_of(const Volume& volume, ValueRange range, std::vector<TransferPoint> points) {
  TransferFunction function;
  function.source = "bench integrators";
  function.domain = ValueDomain::fraction;
  function.points = std::move(points);
  return bake(resolve(function, range), table_layout(volume.info.type, range));
}

std::vector<Scene> scenes_of(const std::string& name, const Volume& volume, int edge) {
  const ValueRange range = scan(volume).range;
  const auto rays = grid_of_rays(volume.info, edge);
  return {{name + ", ramp", &volume,
           table_of(volume, range,
                    {{0.12, {0.8, 0.4, 0.2, 0}}, {0.35, {0.9, 0.6, 0.4, 0.03}}, {1.0, {1.0, 1.0, 0.9, 0.6}}}),
           rays},
          {name + ", band", &volume,
           table_of(volume, range,
                    {{0.22, {0.3, 0.6, 0.9, 0}},
                     {0.27, {0.3, 0.6, 0.9, 0.8}},
                     {0.32, {0.3, 0.6, 0.9, 0}},
                     {0.55, {1.0, 0.9, 0.7, 0}},
                     {0.65, {1.0, 0.9, 0.7, 2.0}}}),
           rays}};
}

struct Errors {
  double rms = 0.0, p99 = 0.0;
};

Errors errors_of(const CastResult& result, const CastResult& exact) {
  std::vector<double> largest;
  double squares = 0.0;
  for (std::size_t i = 0; i < exact.colours.size(); ++i) {
    double most = 0.0;
    for (int c = 0; c < 4; ++c) {
      const double off = std::abs(static_cast<double>(result.colours[i][c] - exact.colours[i][c]));
      squares += off * off;
      most = std::max(most, off);
    }
    largest.push_back(most);
  }
  std::sort(largest.begin(), largest.end());
  return {std::sqrt(squares / static_cast<double>(4 * largest.size())), largest[largest.size() * 99 / 100]};
}

WorkPrecision measure(Caster& caster, const Scene& scene, const CastRule& rule, const CastResult& exact) {
  CastCase wanted{scene.volume, scene.table, scene.rays, rule, SkipKind::distance_map};
  const CastResult skipped = caster(wanted);
  wanted.skip = SkipKind::none;
  const CastResult whole = caster(wanted);
  const Errors errors = errors_of(skipped, exact);
  const auto rays = static_cast<double>(scene.rays.size());
  WorkPrecision point;
  point.scene = scene.name;
  point.rule = rule.integrator;
  point.adaptive = rule.tolerance > 0;
  point.setting = point.adaptive ? rule.tolerance : rule.step_voxels;
  point.samples = static_cast<double>(skipped.work.samples) / rays;
  point.samples_unskipped = static_cast<double>(whole.work.samples) / rays;
  point.error_rms = errors.rms;
  point.error_p99 = errors.p99;
  return point;
}

/// Samples that a curve takes to an error: between its points straight in logarithms; those of its cheapest
/// point where that is good enough already; none where no point is.
std::optional<double> samples_at(std::vector<std::array<double, 2>> curve, double error) {
  std::sort(curve.begin(), curve.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const auto& [n1, e1] = curve[i];
    if (e1 > error) continue;
    if (i == 0) return n1;
    const auto& [n0, e0] = curve[i - 1];
    const double place = std::log(e0 / error) / std::log(e0 / e1);
    return std::exp(std::lerp(std::log(n0), std::log(n1), place));
  }
  return std::nullopt;
}

/// 0 where adaptive steps do not get there and fixed ones do.
double ratio(std::optional<double> fixed, std::optional<double> adaptive) {
  if (!fixed) return std::nan("");
  return adaptive ? *fixed / *adaptive : 0.0;
}

void compare(IntegratorBenchResult& result, const std::string& scene, double error) {
  struct Curve {
    std::vector<std::array<double, 2>> skipped, whole;
  };
  std::map<std::pair<std::string, bool>, Curve> curves;
  for (const WorkPrecision& point : result.points) {
    if (point.scene != scene) continue;
    Curve& curve = curves[{point.rule, point.adaptive}];
    curve.skipped.push_back({point.samples, point.error_rms});
    curve.whole.push_back({point.samples_unskipped, point.error_rms});
  }
  std::optional<double> fewest;
  for (const auto& [key, curve] : curves) {
    const auto samples = key.second ? std::nullopt : samples_at(curve.skipped, error);
    if (samples && (!fewest || *samples < *fewest)) fewest = samples;
  }
  for (const char* rule : {"linear-source", "pre-integrated"}) {
    const Curve &fixed = curves[{rule, false}], &adaptive = curves[{rule, true}];
    const auto a = samples_at(adaptive.skipped, error), a_whole = samples_at(adaptive.whole, error);
    result.savings.push_back({scene, rule, error, ratio(samples_at(fixed.skipped, error), a),
                              ratio(samples_at(fixed.whole, error), a_whole), ratio(fewest, a)});
  }
}

std::vector<std::filesystem::path> scans_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".nrrd") || name.ends_with(".nhdr") || name.ends_with(".nii.gz"))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

IntegratorBenchResult bench_integrators(const IntegratorBenchOptions& options) {
  const gpu::Device device(options.device);
  IntegratorBenchResult result;
  result.device = device.info().name;
  const int edge = options.quick ? 24 : 64;
  Caster caster(device, options.data_folder);
  const auto run = [&](const std::string& name, const Volume& volume) {
    for (const Scene& scene : scenes_of(name, volume, edge)) {
      CastRule exact_rule{
          .integrator = "pre-integrated", .preintegration = "integral", .step_voxels = 1.0 / 64};
      const CastResult exact =
          caster({scene.volume, scene.table, scene.rays, exact_rule, SkipKind::distance_map});
      for (const char* integrator : {"midpoint-exponential", "linear-source", "pre-integrated"}) {
        CastRule rule{.integrator = integrator, .preintegration = "integral", .termination = kTermination};
        for (const double step : {2.0, 1.0, 0.5, 0.25, 0.125, 0.0625}) {
          rule.step_voxels = step;
          result.points.push_back(measure(caster, scene, rule, exact));
        }
      }
      for (const char* integrator : {"linear-source", "pre-integrated"}) {
        CastRule rule{.integrator = integrator, .preintegration = "integral", .termination = kTermination};
        for (const double tolerance : {0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4}) {
          rule.tolerance = tolerance;
          result.points.push_back(measure(caster, scene, rule, exact));
        }
      }
      compare(result, scene.name, kTargetError);
    }
    caster.forget(volume);
  };
  for (const auto& file : scans_in(options.volumes)) {
    const Volume volume = load_volume(*open_volume(file.string()));
    run(file.stem().string(), volume);
    ++result.real_volumes;
    if (options.quick && result.real_volumes == 2) break;
  }
  if (result.real_volumes == 0) {
    for (const char* generator : {"generator:marschner_lobb:64", "generator:fractal_vessels:96"}) {
      const Volume volume = load_volume(*open_volume(generator));
      run(generator, volume);
    }
  }
  std::vector<double> ratios, unskipped, best;
  for (const AdaptiveSaving& saving : result.savings) {
    ratios.push_back(saving.ratio);
    unskipped.push_back(saving.ratio_unskipped);
    best.push_back(saving.ratio_best_fixed);
  }
  result.median_ratio = median(ratios);
  result.median_ratio_unskipped = median(unskipped);
  result.median_ratio_best_fixed = median(best);
  return result;
}

std::string to_text(const IntegratorBenchResult& result) {
  std::string text =
      fmt::format("cast/dvr on {}: samples per ray (with skip/distance_map) and RMS error\n", result.device);
  std::string scene, rule;
  for (const WorkPrecision& point : result.points) {
    if (point.scene != scene) text += "\n" + point.scene + "\n";
    const std::string name = (point.adaptive ? "adaptive, " : "fixed, ") + point.rule;
    if (point.scene != scene || name != rule) text += fmt::format("  {:<32}", name);
    text += fmt::format(" {:g}: {:.1f} {:.1e} (p99 {:.1e});", point.setting, point.samples, point.error_rms,
                        point.error_p99);
    scene = point.scene;
    rule = name;
    const WorkPrecision* next = &point + 1;
    const bool last = next == result.points.data() + result.points.size();
    if (last || next->scene != scene || next->rule != point.rule || next->adaptive != point.adaptive)
      text += "\n";
  }
  text +=
      fmt::format("\nfixed / adaptive samples at an RMS error of {:g}\n  {:<44}{:<18}{:>13}{:>13}{:>18}\n",
                  kTargetError, "scene", "rule", "skipping", "no skipping", "best fixed rule");
  const auto times = [](double value) {
    if (std::isnan(value)) return std::string("fixed never");
    return value > 0 ? fmt::format("{:.2f}x", value) : std::string("not reached");
  };
  for (const AdaptiveSaving& saving : result.savings)
    text += fmt::format("  {:<44}{:<18}{:>13}{:>13}{:>18}\n", saving.scene, saving.rule, times(saving.ratio),
                        times(saving.ratio_unskipped), times(saving.ratio_best_fixed));
  text += fmt::format("  {:<62}{:>12.2f}x{:>12.2f}x{:>17.2f}x\n",
                      fmt::format("median ({} scans)", result.real_volumes), result.median_ratio,
                      result.median_ratio_unskipped, result.median_ratio_best_fixed);
  return text;
}

std::string to_json(const IntegratorBenchResult& result) {
  using Json = nlohmann::ordered_json;
  Json points = Json::array(), savings = Json::array();
  for (const WorkPrecision& p : result.points)
    points.push_back({{"scene", p.scene},
                      {"rule", p.rule},
                      {"steps", p.adaptive ? "adaptive" : "fixed"},
                      {"setting", p.setting},
                      {"samples_per_ray", p.samples},
                      {"samples_per_ray_unskipped", p.samples_unskipped},
                      {"error_rms", p.error_rms},
                      {"error_p99", p.error_p99}});
  for (const AdaptiveSaving& s : result.savings)
    savings.push_back({{"scene", s.scene},
                       {"rule", s.rule},
                       {"error_rms", s.error},
                       {"ratio", s.ratio},
                       {"ratio_unskipped", s.ratio_unskipped},
                       {"ratio_best_fixed", s.ratio_best_fixed}});
  return Json{{"device", result.device},
              {"real_volumes", result.real_volumes},
              {"points", points},
              {"savings", savings},
              {"median_ratio", result.median_ratio},
              {"median_ratio_unskipped", result.median_ratio_unskipped},
              {"median_ratio_best_fixed", result.median_ratio_best_fixed}}
      .dump(2);
}

}  // namespace brace
