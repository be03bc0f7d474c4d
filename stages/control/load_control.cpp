#include "stages/control/load_control.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace brace::stages {

namespace {

constexpr std::uint32_t delay_max = 64;
/// Costs of 0 and beyond all measure stay numbers.
constexpr double log_cost_max = 30.0;

double log_cost(double cost) {
  return std::clamp(std::log(std::max(cost, 1e-300)), -log_cost_max, log_cost_max);
}

double limited(double u, double quality_min) {
  return std::clamp(u, std::log(quality_min), 0.0);
}

}  // namespace

bool pi_control_is_stable(double gamma_p, double gamma_i, std::uint32_t delay_frames) {
  if (!(gamma_p >= 0.0) || !(gamma_i > 0.0) || delay_frames > delay_max) return false;
  // Schur-Cohn: all roots are inside if the last coefficient is smaller than the first, again and again.
  std::array<double, delay_max + 3> a{};
  std::size_t degree = delay_frames + 2;
  a[degree] = 1.0;
  a[degree - 1] -= 1.0;
  a[1] += gamma_p + gamma_i;
  a[0] -= gamma_p;
  for (; degree > 0; --degree) {
    const double first = a[degree], last = a[0];
    if (!(std::abs(last) < std::abs(first))) return false;
    std::array<double, delay_max + 3> next{};
    for (std::size_t k = 1; k <= degree; ++k)
      next[k - 1] = (first * a[k] - last * a[degree - k]) / first;
    a = next;
  }
  return true;
}

double PiControl::update(const FrameLoad& load) {
  const double error = log_cost(load.cost) - std::log(settings_.target);
  const double change = has_error_ ? error - error_ : 0.0;
  error_ = error;
  has_error_ = true;
  u_ = limited(u_ - settings_.p * change - settings_.i * error, settings_.quality_min);
  return std::exp(u_);
}

double QuantileControl::update(const FrameLoad& load) {
  const double p = settings_.missed_share;
  if (load.missed) {
    u_ -= settings_.proportional_cut ? std::max(settings_.step, log_cost(load.cost)) : settings_.step;
  } else {
    u_ += settings_.step * p / (1.0 - p);
  }
  u_ = limited(u_, settings_.quality_min);
  return std::exp(u_);
}

double WindowControl::update(const FrameLoad& load) {
  const std::size_t window = std::clamp<std::size_t>(settings_.window_frames, 2, window_max);
  const double now = log_cost(load.cost);
  // The oldest of the window is where the next one goes. Before it is full, the load is taken to have come
  // from the upper threshold: a start under overload is a change, too.
  const double before = frames_ < window ? log_cost(settings_.load_max) : log_costs_[frames_ % window];
  log_costs_[frames_ % window] = now;
  ++frames_;
  const double change = now - before;
  if (load.missed || load.cost > settings_.load_max) {
    u_ -= settings_.step + settings_.gradient_gain * std::max(change, 0.0);
  } else if (load.cost < settings_.load_min) {
    u_ += settings_.step;  // a fall of the cost may be what was cut: no reason to hurry back
  }
  u_ = limited(u_, settings_.quality_min);
  return std::exp(u_);
}

}  // namespace brace::stages
