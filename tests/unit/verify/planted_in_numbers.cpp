#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/verify/planted_defects.hpp"

namespace brace {

std::vector<PlantedDefect> defects_in_numbers() {
  return {
      // Absorption.
      {"opacity correction by ρα", "absorption",
       [](VerifySubjects& s) {
         s.opacity_corrected = [](double alpha, double rho) { return std::min(1.0, alpha * rho); };
       }},
      {"opacity correction by two terms of its series", "absorption",
       [](VerifySubjects& s) {
         s.opacity_corrected = [](double alpha, double rho) {
           return std::clamp(rho * alpha * (1 - 0.5 * (rho - 1) * alpha), 0.0, 1.0);
         };
       }},
      {"opacity correction without log1p", "absorption",
       [](VerifySubjects& s) {
         s.opacity_corrected = [](double alpha, double rho) {
           return rho == 0 ? 0 : 1 - std::exp(rho * std::log(1 - alpha));
         };
       }},
      {"the thesis' Algorithm 6: κ without the logarithm", "absorption",
       [](VerifySubjects& s) {
         s.kappa_from_opacity = [](double opacity, double length) { return opacity / length; };
       }},
      {"1 − exp in place of expm1", "absorption",
       [](VerifySubjects& s) {
         s.opacity_from_kappa = [](double kappa, double length) { return 1 - std::exp(-kappa * length); };
       }},
      {"opacity correction without its ends", "absorption",
       [](VerifySubjects& s) {
         s.opacity_corrected = [](double alpha, double rho) { return -std::expm1(rho * std::log1p(-alpha)); };
       }},
      {"every accumulator sums opacity", "absorption",
       [](VerifySubjects& s) {
         s.accumulate = [run = s.accumulate](Accumulator, Precision p, double alpha, int n) {
           return run(Accumulator::opacity, p, alpha, n);
         };
       }},
      {"every accumulator sums optical depth", "absorption",
       [](VerifySubjects& s) {
         s.accumulate = [run = s.accumulate](Accumulator, Precision p, double alpha, int n) {
           return run(Accumulator::optical_depth, p, alpha, n);
         };
       }},
      {"every precision is single", "absorption",
       [](VerifySubjects& s) {
         s.accumulate = [run = s.accumulate](Accumulator a, Precision, double alpha, int n) {
           return run(a, Precision::fp32, alpha, n);
         };
       }},
      {"what absorbs nothing absorbs a little", "absorption",
       [](VerifySubjects& s) {
         s.integrate = [integrate = s.integrate](TransferTable table, double step) {
           for (auto& entry : table.entries)
             entry[3] = std::max(entry[3], 1e-9);
           return integrate(table, step);
         };
       }},
      {"transfer integrals by the left rule", "absorption",
       [](VerifySubjects& s) {
         s.integrate = [](const TransferTable& table, double step) {
           TransferIntegrals sums(table.entries.size());
           for (std::size_t i = 1; i < sums.size(); ++i) {
             sums[i] = sums[i - 1];
             const auto& entry = table.entries[i - 1];
             for (std::size_t c = 0; c < 4; ++c)
               sums[i][c] += entry[3] * step / std::log(2.0) * (c < 3 ? entry[c] : 1);
           }
           return sums;
         };
       }},
      // Lenses.
      {"inverse by three steps of a fixed point", "lenses",
       [](VerifySubjects& s) {
         s.lens_inverse = [](sim::LensKind kind, const std::array<double, 5>& k, double source, double,
                             int* n) {
           double r = source;
           for (int i = 0; i < 3; ++i)
             r = source / sim::lens_scale(kind, k, r);
           if (n != nullptr) *n = 3;
           return std::optional<double>(r);
         };
       }},
      {"fold-over 2 % too far out", "lenses",
       [](VerifySubjects& s) {
         s.fold_over_radius = [](sim::LensKind kind, const std::array<double, 5>& k, double r_max) {
           return std::min(r_max, 1.02 * sim::fold_over_radius(kind, k, r_max));
         };
       }},
      {"inverse from beyond the fold", "lenses",
       [](VerifySubjects& s) {
         s.lens_inverse = [](sim::LensKind kind, const std::array<double, 5>& k, double source, double usable,
                             int* n) {
           const auto found = sim::lens_inverse(kind, k, source, usable, n);
           return found ? found : std::optional<double>(usable);
         };
       }},
      {"no fold-over is seen", "lenses",
       [](VerifySubjects& s) {
         s.fold_over_radius = [](sim::LensKind, const std::array<double, 5>&, double r_max) { return r_max; };
       }},
      {"fold-over 2 % too near", "lenses",
       [](VerifySubjects& s) {
         s.fold_over_radius = [](sim::LensKind kind, const std::array<double, 5>& k, double r_max) {
           return 0.98 * sim::fold_over_radius(kind, k, r_max);
         };
       }},
      {"usable up to a rounding past a pole", "lenses",
       [](VerifySubjects& s) {
         s.fold_over_radius = [](sim::LensKind kind, const std::array<double, 5>& k, double r_max) {
           double usable = sim::fold_over_radius(kind, k, r_max);
           if (sim::lens_forward(kind, k, usable) > 1e9) usable *= 1 + 1e-14;
           return usable;
         };
       }},
      {"inverse by bisection", "lenses",
       [](VerifySubjects& s) {
         s.lens_inverse = [](sim::LensKind kind, const std::array<double, 5>& k, double source, double usable,
                             int* n) {
           const auto found = sim::lens_inverse(kind, k, source, usable, n);
           if (n != nullptr) *n = 53;  // to the last bit of a double
           return found;
         };
       }},
      {"no headset is looked at", "lenses",
       [](VerifySubjects& s) {
         s.data_folder = std::filesystem::path(testing::TempDir()) / "brace_without_headsets";
         std::filesystem::create_directories(s.data_folder / "devices");
       }},
      // Motion.
      {"logarithm by acos", "motion",
       [](VerifySubjects& s) {
         s.quat_log = [](const glm::dquat& q) {
           const double half = std::acos(std::min(1.0, std::abs(q.w)));
           const glm::dvec3 axis(q.x, q.y, q.z);
           const double sine = glm::length(axis);
           return sine > 0 ? axis * (2 * half / sine * (q.w < 0 ? -1 : 1)) : axis;
         };
       }},
      {"logarithm without the hemisphere", "motion",
       [](VerifySubjects& s) {
         s.quat_log = [](const glm::dquat& q) {
           const glm::dvec3 axis(q.x, q.y, q.z);
           const double sine = glm::length(axis);
           return sine > 0 ? axis * (2 * std::atan2(sine, q.w) / sine) : axis;
         };
       }},
      {"exponential with half the angle forgotten", "motion",
       [](VerifySubjects& s) { s.quat_exp = [](const glm::dvec3& v) { return quat_exp(2.0 * v); }; }},
      {"exponential to first order", "motion",
       [](VerifySubjects& s) { s.quat_exp = [](const glm::dvec3& v) { return glm::dquat(1.0, 0.5 * v); }; }},
      {"orientations mixed and not normalised", "motion",
       [](VerifySubjects& s) {
         s.pose_at = [](const sim::PoseTrace& trace, SimTime time, sim::Interpolation how) {
           const Pose before = trace.at(time - SimDuration(5'000'000), how),
                      after = trace.at(time + SimDuration(5'000'000), how);
           return Pose{0.5 * before.orientation + 0.5 * after.orientation,
                       0.5 * (before.position + after.position)};
         };
       }},
      {"Hermite is slerp", "motion",
       [](VerifySubjects& s) {
         s.pose_at = [](const sim::PoseTrace& trace, SimTime time, sim::Interpolation) {
           return trace.at(time, sim::Interpolation::slerp_linear);
         };
       }},
      {"resampling takes the nearest pose before", "motion",
       [](VerifySubjects& s) {
         s.pose_at = [](const sim::PoseTrace& trace, SimTime time, sim::Interpolation) {
           const auto& poses = trace.poses();
           const auto after =
               std::upper_bound(poses.begin(), poses.end(), time,
                                [](SimTime t, const sim::TimedPose& pose) { return t < pose.time; });
           return (after == poses.begin() ? poses.front() : *(after - 1)).world_from_head;
         };
       }},
      {"a trace is repaired in silence", "motion",
       [](VerifySubjects& s) {
         s.parse_trace = [](const std::string& text, const std::string& name) {
           auto read = sim::parse_trace(text, name);
           read.repairs = {};
           return read;
         };
       }},
      {"a gap is bridged with poses", "motion",
       [](VerifySubjects& s) {
         s.parse_trace = [](const std::string& text, const std::string& name) {
           auto read = sim::parse_trace(text, name);
           std::vector<sim::TimedPose> poses;
           for (SimTime t = read.trace.begin_time(); t <= read.trace.end_time(); t += SimDuration(10'000'000))
             poses.push_back({t, read.trace.at(t, sim::Interpolation::slerp_linear)});
           read.trace = sim::PoseTrace(name, poses);
           return read;
         };
       }},
      {"vsyncs by a truncated period", "motion",
       [](VerifySubjects& s) {
         s.vsync_time = [](const sim::VsyncClock& clock, std::int64_t index) {
           return clock.epoch() + SimDuration(index * (1'000'000'000 * clock.rate().den / clock.rate().num));
         };
       }},
      {"vsyncs to the microsecond", "motion",
       [](VerifySubjects& s) {
         s.vsync_time = [](const sim::VsyncClock& clock, std::int64_t index) {
           return SimTime(SimDuration(to_ns(clock.time_of(index)) / 1000 * 1000));
         };
       }},
      {"SSIM with C1 below the line only", "motion",
       [](VerifySubjects& s) {
         s.ssim = [](const ImageRgba8& a, const ImageRgba8& b) {
           const double x = a.pixels[0].r, y = b.pixels[0].r;
           return 2 * x * y / (x * x + y * y + std::pow(0.01 * 255, 2));
         };
       }},
      {"SSIM with K1 = 0.03", "motion",
       [](VerifySubjects& s) {
         s.ssim = [](const ImageRgba8& a, const ImageRgba8& b) {
           const double x = a.pixels[0].r, y = b.pixels[0].r, c = std::pow(0.03 * 255, 2);
           return (2 * x * y + c) / (x * x + y * y + c);
         };
       }},
  };
}

}  // namespace brace
