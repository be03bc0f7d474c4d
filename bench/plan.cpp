#include "bench/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/median.hpp"
#include "runtime/metrics/image_error.hpp"
#include "runtime/metrics/pacing.hpp"
#include "runtime/plan/trial.hpp"
#include "runtime/replay/eye_rig.hpp"
#include "runtime/replay/panel_display.hpp"

namespace brace {

namespace {

constexpr std::array off_pixels = {0.125, 0.25, 0.5, 1.0, 2.0};
constexpr std::array scan_out_pixels = {0.25, 0.5, 1.0, 2.0, 4.0};
constexpr int scan_out_bands = 16;  // rows that are taken to be lit together

Session plan_session(const PlanBenchOptions& options, const std::string& volume,
                     const std::string& transfer_function, const std::string& integrator,
                     double step_voxels = 0.5) {
  const std::string text = fmt::format(
      "device.profile = 'htc-vive'\ndevice.resolution_scale = {}\ntrace.neck = {{ motion = 'still' }}\n"
      "pipeline.skip = 'distance_map'\n[scene]\nvolume = '{}'\ntransfer_function = '{}'\nsize_m = 0.8\n"
      "position = 'front:0.8'\n[stage.dvr]\nintegrator = '{}'\nstep_voxels = {}\n",
      options.resolution_scale, volume, transfer_function, integrator, step_voxels);
  return parse_session(text, "bench", ".", {}, options.stages);
}

/// Mean DSSIM of both eyes.
double mean_dssim(const PanelPair& a, const PanelPair& b, const Headset& headset) {
  double sum = 0.0;
  for (const sim::Eye eye : sim::all_eyes) {
    const auto i = static_cast<std::size_t>(eye);
    sum += 0.5 * dssim_from_ssim(ssim(a[i], b[i], visible_pixels(headset, eye)));
  }
  return sum;
}

/// What the panels show of a session's scene from a head pose.
class PlanPictures {
 public:
  PlanPictures(const gpu::Device& device, const PlanBenchOptions& options, Session session)
      : rig_(device, options.data_folder, std::move(session)),
        display_(device, rig_.headset, {options.stages.find("warp", "none", "bench"), {}},
                 options.data_folder) {}

  PanelPair at(const Pose& pose) {
    rig_.renderer.render(pose, rig_.eyes);
    display_.show({rig_.eyes, pose, pose});
    return display_.read();
  }
  const Headset& headset() const { return rig_.headset; }
  EyeRig& rig() { return rig_; }

 private:
  EyeRig rig_;
  PanelDisplay display_;
};

/// Turns about the vertical axis by what moves the view's centre by so many rendered pixels.
Pose turned(const Headset& headset, double off_px) {
  const sim::EyeProfile& eye = headset.profile.eyes[0];
  const double tan_per_px = eye.fov.width() / headset.eye.width_px;
  Pose pose;
  pose.orientation = quat_exp({0.0, std::atan(off_px * tan_per_px), 0.0});
  return pose;
}

/// What panels show that light their rows from top to bottom while the head turns by `scan_out_px`: each band
/// of rows as it is when it is lit. The middle row is that of a head at rest.
PanelPair rolling(PlanPictures& pictures, double scan_out_px) {
  PanelPair shown;
  for (int band = 0; band < scan_out_bands; ++band) {
    const double off_px = scan_out_px * ((band + 0.5) / scan_out_bands - 0.5);
    PanelPair whole = pictures.at(turned(pictures.headset(), off_px));
    if (band == 0) shown = whole;
    for (std::size_t eye = 0; eye < whole.size(); ++eye) {
      const auto row_begin = [&](int of_band) {
        return whole[eye].pixels.begin() + static_cast<std::ptrdiff_t>(whole[eye].height_px * of_band /
                                                                       scan_out_bands * whole[eye].width_px);
      };
      const auto from = row_begin(band), to = row_begin(band + 1);
      std::copy(from, to, shown[eye].pixels.begin() + (from - whole[eye].pixels.begin()));
    }
  }
  return shown;
}

void measure_scene(const gpu::Device& device, const PlanBenchOptions& options, const std::string& volume,
                   const std::string& transfer_function, PlanBenchResult& result) {
  PlanPictures with(device, options, plan_session(options, volume, transfer_function, "pre-integrated"));
  const PanelPair truth = with.at(Pose{});
  for (const double off_px : off_pixels) {
    const PanelPair off = with.at(turned(with.headset(), off_px));
    result.off.push_back({volume, transfer_function, off_px, mean_dssim(off, truth, with.headset())});
  }
  for (const double scan_out_px : scan_out_pixels)
    result.scan_out.push_back({volume, transfer_function, scan_out_px,
                               mean_dssim(rolling(with, scan_out_px), truth, with.headset())});
  PlanPictures without(device, options,
                       plan_session(options, volume, transfer_function, "midpoint-exponential"));
  PlanPictures fine(device, options,
                    plan_session(options, volume, transfer_function, "pre-integrated", 0.125));
  const PanelPair plain = without.at(Pose{}), converged = fine.at(Pose{});
  result.integrators.push_back({volume, transfer_function, mean_dssim(plain, truth, with.headset()),
                                mean_dssim(truth, converged, with.headset()),
                                mean_dssim(plain, converged, with.headset())});
}

/// How far the median time of a trial's frames is from what it is in the long run.
double noise_share(const gpu::Device& device, const PlanBenchOptions& options) {
  EyeRig rig(
      device, options.data_folder,
      plan_session(options, options.volumes.front(), options.transfer_functions.front(), "pre-integrated"));
  rig.render();
  std::vector<double> medians;
  for (int i = 0; i < options.repetitions; ++i) {
    std::vector<double> times_s;
    for (int frame = 0; frame < PlanTrials::probes; ++frame)
      times_s.push_back(to_s(rig.render().device_time));
    medians.push_back(median(std::move(times_s)));
  }
  const double long_run = median(medians);
  for (double& one : medians)
    one = std::abs(one / long_run - 1.0);
  return distribution_of(std::move(medians)).p95;
}

}  // namespace

PlanBenchResult bench_plan(const PlanBenchOptions& options) {
  const gpu::Device device(options.device);
  PlanBenchResult result;
  result.device = device.info().name;
  result.driver = device.info().driver;
  for (const std::string& volume : options.volumes)
    for (const std::string& transfer_function : options.transfer_functions)
      measure_scene(device, options, volume, transfer_function, result);
  result.noise_share = noise_share(device, options);
  return result;
}

std::string to_text(const PlanBenchResult& result) {
  std::string text = fmt::format("{} ({}), HTC Vive\n\nDSSIM of a picture that is off by\n{:<32}{:<12}",
                                 result.device, result.driver, "volume", "transfer");
  for (const double off_px : off_pixels)
    text += fmt::format("{:>8} px", off_px);
  const PlanOffRow* before = nullptr;
  for (const PlanOffRow& row : result.off) {
    if (before == nullptr || before->off_px > row.off_px)
      text += fmt::format("\n{:<32}{:<12}", row.volume, row.transfer_function);
    text += fmt::format("{:>11.2e}", row.dssim);
    before = &row;
  }
  text += fmt::format(
      "\n\nDSSIM of a rolling picture against one lit at once, while the view moves by\n{:<32}{:<12}",
      "volume", "transfer");
  for (const double scan_out_px : scan_out_pixels)
    text += fmt::format("{:>8} px", scan_out_px);
  for (std::size_t i = 0; i < result.scan_out.size(); ++i) {
    const PlanScanOutRow& row = result.scan_out[i];
    if (i % scan_out_pixels.size() == 0)
      text += fmt::format("\n{:<32}{:<12}", row.volume, row.transfer_function);
    text += fmt::format("{:>11.2e}", row.dssim);
  }
  text += fmt::format("\n\nDSSIM without pre-integration\n{:<32}{:<12}{:>12}{:>16}{:>19}\n", "volume",
                      "transfer", "change", "error with it", "error without it");
  for (const PlanIntegratorRow& row : result.integrators)
    text += fmt::format("{:<32}{:<12}{:>12.2e}{:>16.2e}{:>19.2e}\n", row.volume, row.transfer_function,
                        row.change_dssim, row.error_with_dssim, row.error_without_dssim);
  text += fmt::format("\nmedians of {} measured eye frames differ by {:.1f} % (p95)", PlanTrials::probes,
                      100.0 * result.noise_share);
  return text;
}

std::string to_json(const PlanBenchResult& result) {
  nlohmann::ordered_json json{{"device", result.device}, {"driver", result.driver}};
  for (const PlanOffRow& row : result.off)
    json["off"].push_back({{"volume", row.volume},
                           {"transfer_function", row.transfer_function},
                           {"off_px", row.off_px},
                           {"dssim", row.dssim}});
  for (const PlanIntegratorRow& row : result.integrators)
    json["integrators"].push_back({{"volume", row.volume},
                                   {"transfer_function", row.transfer_function},
                                   {"change_dssim", row.change_dssim},
                                   {"error_with_dssim", row.error_with_dssim},
                                   {"error_without_dssim", row.error_without_dssim}});
  for (const PlanScanOutRow& row : result.scan_out)
    json["scan_out"].push_back({{"volume", row.volume},
                                {"transfer_function", row.transfer_function},
                                {"scan_out_px", row.scan_out_px},
                                {"dssim", row.dssim}});
  json["noise_share"] = result.noise_share;
  return json.dump(2);
}

}  // namespace brace
