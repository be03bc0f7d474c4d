#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace brace::stages {

// Controllers of the ray count as u = ln(quality): a frame costs g * quality^gamma, gamma the cost exponent
// (1 where cost is in proportion to rays), so that the loop is linear in u.

/// Whether u(k+1) = u(k) - p (e(k) - e(k-1)) - i e(k) settles when e(k) = gamma u(k - delay) + what disturbs
/// it: all roots of z^(d+2) - z^(d+1) + gamma (p + i) z - gamma p inside the unit circle. With p = 0 this is
/// 0 < gamma i < 2 sin(pi / (2 (2 d + 1))): 2, 1, 0.618, 0.445 for delays of 0 to 3 frames.
bool pi_control_is_stable(double gamma_p, double gamma_i, std::uint32_t delay_frames);

/// What both controllers are told of a frame.
struct FrameLoad {
  double cost = 0;  // over what it may cost: 1 is exactly on time
  bool missed = false;
};

/// Proportional-integral control of ln(cost / target), in velocity form: at a limit of the quality nothing
/// winds up.
class PiControl {
 public:
  struct Settings {
    double target = 0.85;  // share of the budget to use
    double p = 0.1, i = 0.3;
    double quality_min = 0.05;
  };
  explicit PiControl(const Settings& settings) : settings_(settings) {}

  double update(const FrameLoad& load);

 private:
  Settings settings_;
  double u_ = 0, error_ = 0;
  bool has_error_ = false;
};

/// Holds the share of missed frames: a miss takes `step` off u, a frame on time gives step p / (1 - p) back,
/// which balances at the share p (quantile tracking). The misses M of N frames are at most N p + (1 - p) (R +
/// step) / step, R = -ln(quality_min), whatever the costs, as long as a frame one step above quality_min is
/// on time: below that nothing is left to cut, and misses go on uncounted.
class QuantileControl {
 public:
  struct Settings {
    double missed_share = 0.01;  // p
    double step = 0.1;
    double quality_min = 0.05;
    bool proportional_cut = true;  // a miss takes ln(cost) if that is more than `step`
  };
  explicit QuantileControl(const Settings& settings) : settings_(settings) {}

  double update(const FrameLoad& load);

 private:
  Settings settings_;
  double u_ = 0;
};

/// Waschk and Krueger 2021, section 4, on u = ln(quality): above an upper threshold of the last frame's cost
/// u falls by `step` and by a part of what ln(cost) has grown over a window of frames, below a lower one it
/// rises by `step`; between them it rests. Where the paper lets the gradient decide which anchor moves,
/// rays/mab has one order for all qualities: small cuts come from fine levels, large ones from coarse ones.
class WindowControl {
 public:
  static constexpr std::size_t window_max = 64;
  struct Settings {
    std::size_t window_frames = 8;           // 2 ... window_max
    double load_min = 0.75, load_max = 0.9;  // of the budget: below the one more rays, above the other fewer
    double step = 0.02;
    double gradient_gain = 0.8;
    double quality_min = 0.05;
  };
  explicit WindowControl(const Settings& settings) : settings_(settings) {}

  double update(const FrameLoad& load);

 private:
  Settings settings_;
  std::array<double, window_max> log_costs_{};  // the last window_frames, in a ring
  std::size_t frames_ = 0;
  double u_ = 0;
};

}  // namespace brace::stages
