// predict, control and cost: stages that the host calls without a device.
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/pose.hpp"
#include "runtime/conformance/suite.hpp"
#include "runtime/host/native_stage.hpp"
#include "runtime/host/stage_activation.hpp"

namespace brace {

namespace {

/// Common to the three: a native stage without volume or device.
class HostSubject : public Subject {
 public:
  explicit HostSubject(const StageInfo& stage) : info_(stage) {
    if (stage.native == nullptr) {
      throw input_error("{}: stage {} has no native library; a {} stage is a shared library",
                        stage.origin.string(), stage.id(), stage.family);
    }
  }
  void make(const std::vector<double>& values) override {
    counted([&] { stage_ = NativeStage({info_, values}); });
  }
  void activate() override {
    counted([&] { stage_.activate(); });
  }
  void deactivate() override {
    counted([&] { stage_.deactivate(); });
  }
  void unmake() override {
    counted([&] { stage_ = NativeStage(); });
  }
  bool is_native() const override { return true; }
  bool runs_on_host() const override { return true; }

 protected:
  /// Runs a call into the stage, counts what it allocates, and turns its failure into an error.
  template <typename Call>
  void count(Trial& trial, Call&& call) {
    brace_result result = BRACE_ERROR;
    counted([&] { result = call(); }, &trial);
    if (result != BRACE_OK) {
      const char* said =
          info_.native->last_error != nullptr ? info_.native->last_error(stage_.self()) : nullptr;
      throw device_error("a call returned {}{}{}", static_cast<int>(result), said != nullptr ? ": " : "",
                         said != nullptr ? said : "");
    }
  }

  StageInfo info_;
  NativeStage stage_;
};

brace_tracker_sample reading(std::int64_t time_ns, double turn_rad, double rate_rad_s) {
  brace_tracker_sample sample{};
  sample.time_ns = time_ns;
  sample.world_from_head =
      to_abi(Pose{quat_exp({0.2 * turn_rad, turn_rad, 0.0}), {0.1 * turn_rad, 1.6, 0.0}});
  sample.angular_velocity_rad_s[1] = rate_rad_s;
  sample.linear_velocity_m_s[0] = 0.1 * rate_rad_s;
  return sample;
}

class PredictSubject final : public HostSubject {
 public:
  using HostSubject::HostSubject;

  Trial use() override {
    Trial trial;
    std::vector<brace_tracker_sample> history;
    for (std::int64_t k = 0; k < 64; ++k) {
      const double turn = std::sin(0.05 * static_cast<double>(k));
      history.push_back(reading(k * 2'000'000, turn, 25.0 * std::cos(0.05 * static_cast<double>(k))));
    }
    trial.outputs.reserve(64 * sizeof(brace_pose));
    for (std::size_t newest = 1; newest <= history.size(); ++newest) {
      const std::size_t oldest = newest > 16 ? newest - 16 : 0;
      ask(trial,
          {history.begin() + static_cast<std::ptrdiff_t>(oldest),
           history.begin() + static_cast<std::ptrdiff_t>(newest)},
          22'000'000);
    }
    return trial;
  }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    finite_ = unit_ = 0;
    Trial all;
    suite.clause("extreme input is served", [&] {
      const Life life(*this, values);
      (void)use();
      for (const double jump : {0.0, 3.1, 3.141592653589793, -3.1}) {
        ask(all, {reading(1'000'000'000, jump, 0.0)}, 0);                 // a single reading
        ask(all, {reading(1'100'000'000, jump, 900.0)}, -2'000'000'000);  // far in the past
        ask(all, {reading(1'100'000'001, jump, 900.0), reading(9'000'000'000, -jump, 0.0)},
            0);  // after a gap
        ask(all, {reading(9'100'000'000, jump, 1e4), reading(9'100'000'001, -jump, 1e4)},
            500'000'000);  // 1 ns apart
      }
      return fmt::format("{} predictions", all.values);
    });
    const auto share = [&](std::uint64_t bad, const char* what) {
      if (bad != 0) throw Broken(fmt::format("{} of {} poses {}", bad, asked_, what));
      return fmt::format("0 of {} poses {}", asked_, what);
    };
    suite.clause("poses are finite", [&] { return share(finite_, "with NaN or Inf"); });
    suite.clause("orientations are unit quaternions", [&] { return share(unit_, "off by more than 1e-6"); });
  }

 private:
  void ask(Trial& trial, const std::vector<brace_tracker_sample>& history, std::int64_t ahead_ns) {
    brace_pose pose{};
    count(trial, [&] {
      return stage_.predict_functions().predict(stage_.self(), history.data(),
                                                static_cast<std::uint32_t>(history.size()),
                                                history.back().time_ns + ahead_ns, &pose);
    });
    double length = 0.0, sum = 0.0;
    for (const double q : pose.orientation_xyzw)
      length += q * q, sum += q;
    for (const double p : pose.position_m)
      sum += p;
    ++asked_;
    ++trial.values;
    if (!std::isfinite(sum)) {
      ++finite_;
      trial.violation = "a pose with NaN or Inf";
    } else if (std::abs(length - 1.0) > 2e-6) {
      ++unit_;
      trial.violation = "an orientation that is no unit quaternion";
    }
    append(trial.outputs, &pose, 1);
  }

  std::uint64_t asked_ = 0, finite_ = 0, unit_ = 0;
};

class ControlSubject final : public HostSubject {
 public:
  using HostSubject::HostSubject;

  Trial use() override {
    Trial trial;
    trial.outputs.reserve(200 * sizeof(double));
    for (std::uint64_t frame = 0; frame < 200; ++frame) {
      const std::int64_t cost_ns = frame < 100 ? 6'000'000 : 40'000'000;
      ask(trial, {sizeof(brace_control_input), frame, cost_ns, 11'111'111, frame < 100 ? 0u : 3u, 1u});
    }
    return trial;
  }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    suite.clause("quality within (0, 1]", [&] {
      const Life life(*this, values);
      Trial trial = use();
      constexpr std::int64_t forever = std::numeric_limits<std::int64_t>::max() / 4;
      for (const std::int64_t cost_ns : {std::int64_t{0}, std::int64_t{1}, forever}) {
        for (const std::int64_t budget_ns : {std::int64_t{1}, std::int64_t{11'111'111}, forever}) {
          for (const std::uint32_t missed : {0u, 1u, 1000u}) {
            for (std::uint64_t frame = 0; frame < 50; ++frame) {
              ask(trial, {sizeof(brace_control_input), frame, cost_ns, budget_ns, missed, missed % 5});
            }
          }
        }
      }
      if (!trial.violation.empty()) throw Broken(trial.violation);
      return fmt::format("{} updates", trial.values);
    });
  }

 private:
  void ask(Trial& trial, const brace_control_input& input) {
    double quality = 0.0;
    count(trial, [&] { return stage_.control_functions().update(stage_.self(), &input, &quality); });
    ++trial.values;
    if (!(quality > 0.0 && quality <= 1.0) && trial.violation.empty()) {
      trial.violation = fmt::format("quality {} for cost {} ns, budget {} ns, {} missed", quality,
                                    input.frame_cost_ns, input.budget_ns, input.missed);
    }
    append(trial.outputs, &quality, 1);
  }
};

class CostSubject final : public HostSubject {
 public:
  using HostSubject::HostSubject;

  Trial use() override {
    Trial trial;
    trial.outputs.reserve(64 * sizeof(std::int64_t));
    for (std::uint64_t k = 0; k < 64; ++k)
      ask(trial, "cast", {1000 * k, 90'000 * k, 7 * k, k, 4000 * k, 1 << 20});
    return trial;
  }

  void own_clauses(Suite& suite, const std::vector<double>& values) override {
    suite.clause("durations are not negative", [&] {
      const Life life(*this, values);
      Trial trial = use();
      constexpr std::uint64_t many = 1'000'000'000'000ull;
      for (const char* job : {"cast", "warp", "update"}) {
        ask(trial, job, {0, 0, 0, 0, 0, 0});
        ask(trial, job, {many, many, many, many, many, many});
      }
      if (!trial.violation.empty()) throw Broken(trial.violation);
      return fmt::format("{} jobs", trial.values);
    });
  }

 private:
  void ask(Trial& trial, const char* job, const brace_work_counts& work) {
    std::int64_t duration_ns = -1;
    count(trial, [&] { return stage_.cost_functions().cost(stage_.self(), job, &work, &duration_ns); });
    ++trial.values;
    if (duration_ns < 0 && trial.violation.empty()) {
      trial.violation = fmt::format("{} ns for a {} job of {} samples", duration_ns, job, work.samples);
    }
    append(trial.outputs, &duration_ns, 1);
  }
};

}  // namespace

std::unique_ptr<Subject> make_host_subject(const StageInfo& stage) {
  if (stage.family == "predict") return std::make_unique<PredictSubject>(stage);
  if (stage.family == "control") return std::make_unique<ControlSubject>(stage);
  return std::make_unique<CostSubject>(stage);
}

}  // namespace brace
