// Quaternions, resampling of traces, broken traces, vsync times, SSIM.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "hmd_sim/trace_generators.hpp"
#include "runtime/verify/verify.hpp"

namespace brace {

namespace {

void verify_quaternions(const VerifySubjects& subjects, Claims& claims) {
  Largest back, norm, sign, angle;
  const glm::dvec3 axes[] = {{1, 0, 0}, {0, -1, 0}, {0.6, 0, -0.8}, {0.48, 0.6, 0.64}};
  for (const glm::dvec3& axis : axes) {
    for (int exponent = -12; exponent <= 0; ++exponent) {
      for (const double digit : {1.0, 2.5, 3.1}) {
        const double theta = std::min(digit * std::pow(10.0, exponent), std::numbers::pi - 1e-9);
        const glm::dquat q = subjects.quat_exp(axis * theta);
        const glm::dvec3 v = subjects.quat_log(q);
        back.see(glm::length(v - axis * theta) / theta);
        norm.see(std::abs(glm::length(q) - 1));
        sign.see(glm::length(subjects.quat_log(-q) - v) / theta);
        // Two half turns are the whole one.
        const glm::dquat half = subjects.quat_exp(axis * (theta / 2));
        angle.see(glm::length(subjects.quat_log(half * half) - axis * theta) / theta);
      }
    }
  }
  claims.add("log(exp(v)) against v, 1e-12 … π rad: largest relative error", back.value(), at_most(1e-9));
  claims.add("| |exp(v)| − 1 |, largest", norm.value(), at_most(1e-14));
  claims.add("log(−q) against log(q), largest relative difference", sign.value(), at_most(1e-9));
  claims.add("exp(v/2)² against exp(v), largest relative error", angle.value(), at_most(1e-9));
  const glm::dvec3 at_pi = subjects.quat_log(glm::dquat(0, 0, -1, 0)),
                   other = subjects.quat_log(glm::dquat(0, 0, 1, 0));
  claims.add("at π rad both signs of q give one vector: difference", glm::length(at_pi - other), exactly(0));
}

double resampling_error(const VerifySubjects& subjects, sim::Interpolation interpolation, double interval_s) {
  const sim::NaturalMotion motion(3);
  std::vector<sim::TimedPose> poses;
  for (int i = 0; i * interval_s < 2.0; ++i)
    poses.push_back({SimTime(from_s(i * interval_s)), motion.at(i * interval_s)});
  const sim::PoseTrace trace("natural", poses);
  double error = 0.0;
  for (double t = 0.5; t < 1.5; t += interval_s / 7) {
    const Pose pose = subjects.pose_at(trace, SimTime(from_s(t)), interpolation);
    const double off = angle_between_rad(pose.orientation, motion.at(to_s(from_s(t))).orientation);
    error = off > error || std::isnan(off) ? off : error;
  }
  return error;
}

std::string broken_trace() {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  const auto line = [&](const std::string& t, const std::string& q) { text += t + " 0 1.6 0 " + q + "\n"; };
  line("0.000", "0 0 0 1");
  line("0.010", "0 0 0 1.005");              // renormalised
  line("0.020", "nan 0 0 1");                // dropped
  line("0.005", "0 0 0 1");                  // back in time: dropped
  line("0.030", "0 0 0 2");                  // no rotation: dropped
  line("0.040", "0 0 0 -1");                 // the same rotation: sign kept continuous
  line("0.040", "0 0 0 1");                  // the same time: dropped
  line("0.200", "0 0.0998334 0 0.9950042");  // after a gap
  line("0.210", "0 0.0998334 0 0.9950042");
  return text;
}

void verify_traces(const VerifySubjects& subjects, Claims& claims) {
  const auto order = [&](sim::Interpolation interpolation) {
    return std::log2(resampling_error(subjects, interpolation, 0.04) /
                     resampling_error(subjects, interpolation, 0.02));
  };
  claims.add("resampling by slerp: observed order", order(sim::Interpolation::slerp_linear),
             within(1.7, 2.4));
  claims.add("resampling by Hermite: observed order", order(sim::Interpolation::hermite), within(3.4, 5.0));

  const sim::TraceReadResult read = subjects.parse_trace(broken_trace(), "broken.txt");
  claims.add("a broken trace: poses kept", static_cast<double>(read.repairs.poses_kept), exactly(5), "of 9");
  claims.add("a broken trace: not-a-number dropped", static_cast<double>(read.repairs.dropped_non_finite),
             exactly(1));
  claims.add("a broken trace: no rotation dropped", static_cast<double>(read.repairs.dropped_bad_quaternion),
             exactly(1));
  claims.add("a broken trace: times that do not rise dropped", static_cast<double>(read.repairs.dropped_time),
             exactly(2));
  claims.add("a broken trace: renormalised", static_cast<double>(read.repairs.renormalised), at_least(1));
  claims.add("a broken trace: gaps marked", static_cast<double>(read.repairs.gaps), exactly(1));
  int invalid = 0, wrong = 0;
  for (int ms = -50; ms <= 300; ++ms) {
    const SimTime time = SimTime(from_s(ms * 1e-3));
    const Pose pose = subjects.pose_at(read.trace, time, sim::Interpolation::hermite);
    wrong +=
        !(std::abs(glm::length(pose.orientation) - 1) < 1e-9) || !std::isfinite(glm::length(pose.position));
    invalid += !read.trace.valid_at(time);
  }
  claims.add("a broken trace, every ms: poses that are no poses", wrong, exactly(0), "of 351");
  claims.add("a broken trace, every ms: times that nobody knows of", invalid, within(290, 302), "of 351");
}

void verify_clock(const VerifySubjects& subjects, Claims& claims) {
  const sim::VsyncClock clock(SimTime(), {90, 1}), ntsc(SimTime(), {60000, 1001});
  claims.add("90 Hz: drift after an hour",
             static_cast<double>(to_ns(subjects.vsync_time(clock, 324'000)) - 3'600'000'000'000), exactly(0),
             "ns");
  claims.add("59.94 Hz: drift after 1,001 s",
             static_cast<double>(to_ns(subjects.vsync_time(ntsc, 60'000)) - 1'001'000'000'000), exactly(0),
             "ns");
  std::int64_t shortest = 1'000'000'000, longest = 0;
  for (std::int64_t i = 0; i < 1000; ++i) {
    const std::int64_t period =
        to_ns(subjects.vsync_time(clock, i + 1)) - to_ns(subjects.vsync_time(clock, i));
    shortest = std::min(shortest, period);
    longest = std::max(longest, period);
  }
  claims.add("90 Hz: periods differ by at most", static_cast<double>(longest - shortest), at_most(1), "ns");
}

void verify_ssim(const VerifySubjects& subjects, Claims& claims) {
  const auto grey = [](std::uint8_t value) {
    ImageRgba8 image(16, 16);
    std::fill(image.pixels.begin(), image.pixels.end(), Rgba8{value, value, value, 255});
    return image;
  };
  claims.add("SSIM of greys 100 and 110 against 0.99547644",
             std::abs(subjects.ssim(grey(100), grey(110)) - 0.99547644), at_most(1e-8));
  claims.add("SSIM of a picture with itself", subjects.ssim(grey(77), grey(77)), exactly(1));
}

}  // namespace

void verify_motion(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  verify_quaternions(subjects, claims);
  verify_traces(subjects, claims);
  verify_clock(subjects, claims);
  verify_ssim(subjects, claims);
}

}  // namespace brace
