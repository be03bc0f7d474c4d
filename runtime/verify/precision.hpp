#pragma once

#include <string>

namespace brace {

// Rules of integration and of accumulation in single and half precision, run on the CPU: what a kernel of
// that precision would do. The kernels of cast/dvr use the exponential rules and sum optical depths.

enum class Precision { fp32, fp16, fixed8 };  // fixed8: an 8-bit frame buffer, rounded to nearest

/// Rounds to the precision, to nearest even; halves overflow to infinity.
double rounded(double value, Precision precision);

enum class StabilityRule {
  euler,           // alpha = kappa dt
  thesis,          // alpha = 1 - exp(-kappa dt), colour e dt (Buchacher 2017, eqs. 7-8)
  crank_nicolson,  // T' = T (1 - x/2) / (1 + x/2)
  exponential_left,
  exponential_midpoint,
  linear_source
};
std::string to_string(StabilityRule rule);

/// A slab of constant kappa whose colour goes from 0.2 to 0.8 in 32 steps of kappa dt = x.
struct StabilityRun {
  bool bounded = false;  // 0 <= C <= 0.8, 0 <= T <= 1 and finite after every step
  double error = 0.0;    // of C at the end against the exact solution
};
StabilityRun run_stability(StabilityRule rule, Precision precision, double x);

enum class Accumulator { opacity, transmittance, optical_depth };

/// Opacity after `steps` segments of opacity alpha, accumulated in the given precision: A += (1 - A) alpha,
/// T *= 1 - alpha, or the sum of -log(1 - alpha) and one exponential at the end. Opacity goes on until it
/// stands still if `steps` is larger.
double accumulate(Accumulator accumulator, Precision precision, double alpha, int steps);

}  // namespace brace
