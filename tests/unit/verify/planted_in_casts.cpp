#include <algorithm>
#include <cmath>

#include "tests/unit/verify/planted_defects.hpp"

namespace brace {

namespace {

/// Hands every cast on changed.
std::function<void(VerifySubjects&)> with_rule(std::function<void(CastCase&)> change) {
  return [change](VerifySubjects& subjects) {
    subjects.cast = [cast = subjects.cast, change](CastCase wanted) {
      change(wanted);
      return cast(wanted);
    };
  };
}

std::function<void(VerifySubjects&)> with_result(std::function<void(const CastCase&, CastResult&)> spoil) {
  return [spoil](VerifySubjects& subjects) {
    subjects.cast = [cast = subjects.cast, spoil](const CastCase& wanted) {
      CastResult result = cast(wanted);
      spoil(wanted, result);
      return result;
    };
  };
}

}  // namespace

std::vector<PlantedDefect> defects_in_casts() {
  return {
      // Integrators.
      {"midpoint samples at the left", "integrators", with_rule([](CastCase& c) {
         if (c.rule.integrator == "midpoint-exponential") c.rule.integrator = "left";
       })},
      {"linear source takes the middle's colour", "integrators", with_rule([](CastCase& c) {
         if (c.rule.integrator == "linear-source") c.rule.integrator = "midpoint-exponential";
       })},
      {"pre-integration samples", "integrators", with_rule([](CastCase& c) {
         if (c.rule.integrator == "pre-integrated") c.rule.integrator = "midpoint-exponential";
       })},
      {"absorption a third too strong", "integrators", with_rule([](CastCase& c) {
         for (auto& entry : c.table.entries)
           entry[3] *= 1.33;
       })},
      {"the left rule samples in the middle", "integrators", with_rule([](CastCase& c) {
         if (c.rule.integrator == "left") c.rule.integrator = "midpoint-exponential";
       })},
      {"last segment not cut at the exit", "integrators", with_rule([](CastCase& c) {
         for (CastRay& ray : c.rays)
           ray.entry.w += 0.25f;
       })},
      {"colour clamped to 8 bits", "integrators", with_result([](const CastCase&, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           colour = glm::round(colour * 255.0f) / 255.0f;
       })},
      // Adaptive.
      {"tolerance ignored", "adaptive", with_rule([](CastCase& c) {
         if (c.rule.tolerance > 0) c.rule.tolerance = 0.5;
       })},
      {"always the smallest steps", "adaptive", with_rule([](CastCase& c) {
         if (c.rule.tolerance > 0) c.rule.tolerance = 1e-4;
       })},
      {"adaptive steps lose a tenth of what they cross", "adaptive", with_rule([](CastCase& c) {
         if (c.rule.tolerance <= 0) return;
         for (auto& entry : c.table.entries)
           entry[3] *= 0.9;
       })},
      // Stability.
      {"explicit Euler instead of the exponentials", "stability",
       [](VerifySubjects& s) {
         s.run_stability = [run = s.run_stability](StabilityRule rule, Precision p, double x) {
           return run(rule >= StabilityRule::exponential_left ? StabilityRule::euler : rule, p, x);
         };
       }},
      {"nobody looks whether a ray leaves its bounds", "stability",
       [](VerifySubjects& s) {
         s.run_stability = [run = s.run_stability](StabilityRule rule, Precision p, double x) {
           return StabilityRun{true, run(rule, p, x).error};
         };
       }},
      {"halves where singles are claimed", "stability",
       [](VerifySubjects& s) {
         s.run_stability = [run = s.run_stability](StabilityRule rule, Precision, double x) {
           return run(rule, Precision::fp16, x);
         };
       }},
      {"0/0 in the thinnest medium", "stability", with_result([](const CastCase& c, CastResult& r) {
         if (c.rule.integrator == "linear-source") r.colours.front().r = NAN;
       })},
      {"overflow in the densest medium", "stability", with_result([](const CastCase& c, CastResult& r) {
         if (c.rule.integrator == "pre-integrated") r.colours.back().a = INFINITY;
       })},
      {"colour above the opacity", "stability", with_result([](const CastCase&, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           colour.r *= 1.01f;
       })},
      // Splitting.
      {"a ray forgets its first sample", "absorption", with_rule([](CastCase& c) {
         for (CastRay& ray : c.rays)
           ray.entry.w -= 0.01f;
       })},
      // Skipping.
      {"occupancy by the presence of voxel values", "skipping",
       with_rule([](CastCase& c) { c.occupancy = Occupancy::voxel; })},
      {"rays end a step early behind empty space", "skipping", with_rule([](CastCase& c) {
         if (c.skip == SkipKind::none) return;
         for (CastRay& ray : c.rays)
           ray.entry.w *= 0.5f;
       })},
      {"one bit in one ray", "skipping", with_result([](const CastCase& c, CastResult& r) {
         if (c.skip == SkipKind::octree) r.colours[100].g = std::nextafter(r.colours[100].g, 1.0f);
       })},
      {"nothing is skipped", "skipping", with_rule([](CastCase& c) { c.skip = SkipKind::none; })},
      // Extremes.
      {"not a number where nothing is visible", "extremes", with_result([](const CastCase& c, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           if (colour.a == 0.0f && c.rule.integrator == "left") colour.g = NAN;
       })},
      {"opaque is not quite opaque", "extremes", with_result([](const CastCase&, CastResult& r) {
         for (glm::vec4& colour : r.colours)
           colour *= 0.98f;
       })},
      {"a ray that leaps over everything keeps what its buffer held", "extremes",
       with_result([](const CastCase& c, CastResult& r) {
         if (c.skip == SkipKind::none) return;
         for (glm::vec4& colour : r.colours)
           if (colour.a == 0.0f) colour = glm::vec4(0.25f, 0.25f, 0.25f, 0.5f);
       })},
  };
}

}  // namespace brace
