#include "tests/unit/report/made_up_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace brace {

namespace {

std::int64_t vsync_time_ns(std::int64_t k) {
  return k * 1'000'000'000 / 90;
}

double head_speed(double t_s) {
  const double phase = std::fmod(t_s, 2.0);
  return phase < 1.0 ? std::sin(std::numbers::pi * phase) : 0.02;
}

}  // namespace

MadeUpRun made_up_run(const MadeUpParams& params) {
  std::mt19937 random(params.seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  MadeUpRun run;
  std::int64_t cast_start_ns = 0;
  std::int64_t cast_end_ns = -1;
  std::int64_t next_frame = 0;
  FrameRecord shown;
  JobRecord cast;
  const auto begin_cast = [&](std::int64_t at_ns) {
    const double load =
        1.0 + 1.4 * std::pow(std::max(0.0, std::sin(static_cast<double>(at_ns) * 6e-10)), 6.0);
    cast_start_ns = at_ns;
    cast_end_ns =
        at_ns + static_cast<std::int64_t>(1e6 * params.cast_ms * load * std::exp(0.08 * noise(random)));
  };
  begin_cast(1'200'000);
  for (int k = 0; k < params.vsyncs; ++k) {
    const std::int64_t vsync_ns = vsync_time_ns(k);
    FrameRecord r = shown;
    r.vsync_index = k;
    r.vsync_ns = vsync_ns;
    r.missed = true;
    r.dssim_left = r.dssim_right = std::nan("");
    while (cast_end_ns <= vsync_ns - 1'500'000) {
      r.displayed_frame = next_frame;
      r.render_pose_ns = cast_start_ns - 2'000'000;
      r.render_start_ns = cast_start_ns;
      r.render_done_ns = cast_end_ns;
      r.work = {.rays = 160'000, .samples = 21'000'000, .texels = 2'592'000};
      r.missed = false;
      run.jobs.push_back({.job = static_cast<std::int64_t>(run.jobs.size()),
                          .kind = JobKind::cast,
                          .index = next_frame++,
                          .submit_ns = cast_start_ns,
                          .start_ns = cast_start_ns,
                          .end_ns = cast_end_ns,
                          .cost_ns = cast_end_ns - cast_start_ns,
                          .work = r.work});
      begin_cast(cast_end_ns + 60'000);
    }
    r.stale_run = r.missed ? shown.stale_run + 1 : 0;
    if (r.displayed_frame < 0) {
      r.stale_run = 0;
      run.records.push_back(r);
      continue;
    }
    r.warp_pose_ns = vsync_ns - 3'000'000;
    r.warp_start_ns = vsync_ns - 1'400'000;
    r.warp_done_ns = vsync_ns - 800'000 + static_cast<std::int64_t>(3e4 * noise(random));
    run.jobs.push_back({.job = static_cast<std::int64_t>(run.jobs.size()),
                        .kind = JobKind::warp,
                        .index = k,
                        .submit_ns = r.warp_start_ns,
                        .start_ns = r.warp_start_ns,
                        .end_ns = r.warp_done_ns,
                        .cost_ns = r.warp_done_ns - r.warp_start_ns,
                        .work = {}});
    r.photon_first_row_ns = vsync_ns + 1'000'000;
    r.photon_mid_ns = vsync_ns + 5'400'000;
    r.photon_last_row_ns = vsync_ns + 9'900'000;
    r.mtp_rotation_ns = r.photon_mid_ns - r.warp_pose_ns;
    r.mtp_translation_ns = r.photon_mid_ns - r.render_pose_ns;
    r.frame_age_ns = vsync_ns - r.render_pose_ns;
    const double t_s = static_cast<double>(vsync_ns) * 1e-9;
    const double age_s = static_cast<double>(r.mtp_translation_ns) * 1e-9;
    r.angular_error_rad = 0.05 * head_speed(t_s) * 0.0084 * (1.0 + 0.2 * noise(random));
    r.position_error_m = 0.3 * head_speed(t_s) * age_s;
    const double error = params.dssim_scale * (0.004 + 1.6 * head_speed(t_s) * age_s);
    r.dssim_left = std::clamp(error * (1.0 + 0.05 * noise(random)), 0.0, 1.0);
    r.dssim_right = std::clamp(error * (1.1 + 0.05 * noise(random)), 0.0, 1.0);
    r.angular_error_vector_rad = {0.0, r.angular_error_rad, 0.0};
    r.render_target_ns = r.photon_mid_ns;
    shown = r;
    run.records.push_back(r);
  }
  return run;
}

ImageRgba8 made_up_eye(int size_px, double turn_rad) {
  ImageRgba8 image(size_px, size_px * 10 / 9);
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      const double u = 2.0 * x / image.width_px - 1.0, v = 2.0 * y / image.height_px - 1.0;
      const double r = std::hypot(u, v);
      const double lobes = 0.5 + 0.5 * std::cos(30.0 * r + 4.0 * std::sin(3.0 * std::atan2(v, u) + turn_rad));
      const double value = r < 0.55 ? 0.35 + 0.65 * lobes : r < 0.95 ? 0.06 : 0.0;
      const auto level = [&](double gain) {
        return static_cast<std::uint8_t>(std::clamp(255.0 * value * gain, 0.0, 255.0));
      };
      image.at(x, y) = {level(1.0), level(0.82), level(0.72), 255};
    }
  }
  return image;
}

ReportInput made_up_input() {
  ReportInput input;
  input.version = "0.1.0";
  input.device = "htc-vive";
  input.refresh_hz = 90.0;
  input.resolution_scale = 0.25;
  input.trace = "recorded_headset.csv";
  input.clock = {"virtual", "single", "model:gtx-1080", "full"};
  input.deterministic = true;
  input.facts = {{"Volume", "ch2bet.nii.gz, 181×217×181 uint8"}, {"Trace repairs", "none"}};
  input.tables = {{"Prediction error",
                   "Angle between predicted and true orientation.",
                   {"Horizon, ms", "mean, °", "p95, °", "max, °"},
                   {{"11.1", "0.079", "0.150", "0.185"}, {"22.2", "0.310", "0.590", "0.730"}}}};
  input.session_toml = "[device]\nprofile = \"htc-vive\"\n# </script> & <b> stay text\n";
  input.host = {12.34, 23.1, 400u << 20, {{"gpu", "llvmpipe (LLVM 15.0.6, 256 bits)"}, {"threads", "2"}}};
  return input;
}

}  // namespace brace
