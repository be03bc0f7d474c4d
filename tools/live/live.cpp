// brace live: the simulated headset in a window.
#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/core.h>

#include "base/error.hpp"
#include "hmd_sim/trace_io.hpp"
#include "runtime/metrics/pacing.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"
#include "tools/live/live_eyes.hpp"
#include "tools/live/window.hpp"
#include "tools/live/window_picture.hpp"

namespace brace {

namespace {

constexpr double probe_scale = 0.1;
constexpr double scale_min = 0.03;
constexpr int window_width_px = 960, window_height_px = 540;

SimTime run_time(std::chrono::steady_clock::time_point begin) {
  return SimTime(std::chrono::steady_clock::now() - begin);
}

/// Where the head is: on the session's trace, over and over, or where mouse and keys have put it.
class LiveHead {
 public:
  explicit LiveHead(const Session& session, const std::filesystem::path& data_folder)
      : trace_(load_head_trace(session.trace, data_folder).trace),
        start_(trace_.begin_time() + from_s(session.trace.start_s)) {
    if (start_ >= trace_.end_time()) start_ = trace_.begin_time();
  }

  Pose at(SimTime time) const {
    if (by_hand_) return control_.pose();
    const SimDuration length = trace_.end_time() - start_;
    const SimDuration in = length > SimDuration(0) ? time.time_since_epoch() % length : SimDuration(0);
    return trace_.at(start_ + in, sim::Interpolation::hermite);
  }

  /// Any motion by hand takes the head over; 'T' gives it back to the trace.
  void steer(const LiveWindow& window, SimTime time, double seconds) {
    const HeadInput& input = window.head();
    const bool moved = input.turn_right_rad != 0 || input.turn_up_rad != 0 || input.right != 0 ||
                       input.up != 0 || input.forward != 0;
    if (moved && !by_hand_) {
      control_.start_from(at(time));
      by_hand_ = true;
    }
    if (by_hand_) control_.advance(input, seconds);
    if (window.pressed('T')) by_hand_ = false;
  }
  bool by_hand() const { return by_hand_; }

 private:
  sim::PoseTrace trace_;
  SimTime start_;
  HeadControl control_;
  bool by_hand_ = false;
};

/// Records while asked to, and writes a trace when that ends.
class Recorder {
 public:
  explicit Recorder(std::filesystem::path file) : file_(std::move(file)), on_(!file_.empty()) {
    if (file_.empty()) file_ = "live.trace";
  }
  void toggle() {
    if (on_) write();
    on_ = !on_;
  }
  void add(SimTime time, const Pose& pose) {
    if (on_) poses_.add(time, pose);
  }
  bool on() const { return on_; }
  void write() {
    if (on_ && poses_.can_be_a_trace()) {
      sim::write_trace(file_, poses_.trace(), sim::TraceFormat::brace);
      fmt::print(stderr, "live: {} poses in {}\n", poses_.size(), file_.string());
    }
    poses_ = {};
  }

 private:
  std::filesystem::path file_;
  bool on_;
  HeadRecording poses_;
};

struct LiveFigures {
  std::vector<double> interval_ms, cast_ms;
};

std::string title_of(const LiveEyes& eyes, const LiveFigures& figures, const Recorder& recorder,
                     const LiveHead& head, const std::string& fault) {
  const std::vector<double>& intervals = figures.interval_ms;
  const std::size_t last = std::min<std::size_t>(intervals.size(), 30);
  double sum = 0.0;
  for (std::size_t i = intervals.size() - last; i < intervals.size(); ++i)
    sum += intervals[i];
  std::string title =
      fmt::format("{} - {:.0f} fps, cast {:.1f} ms, {} x {} px per eye, {}", eyes.session().name,
                  sum > 0.0 ? 1e3 * static_cast<double>(last) / sum : 0.0,
                  figures.cast_ms.empty() ? 0.0 : figures.cast_ms.back(), eyes.headset().eye.width_px,
                  eyes.headset().eye.height_px, head.by_hand() ? "by hand (T: trace)" : "trace");
  if (recorder.on()) title += ", recording";
  if (!fault.empty()) title += " - " + fault;
  std::replace(title.begin(), title.end(), '\n', ' ');
  return title;
}

/// Host time of the slower one of two head poses, at a scale.
double time_ms(const gpu::Device& device, const ReplayOptions& options, const LiveCommand& command,
               const StageRegistry& stages, const LiveHead& head, double scale) {
  Overrides overrides = parse_settings(command.set);
  overrides.emplace_back("device.resolution_scale", fmt::format("{}", scale));
  LiveEyes eyes(
      device, options, [&] { return read_session(command.session, overrides, stages); }, head.at(SimTime()));
  double slowest_ms = 0.0;
  for (const SimTime time : {SimTime(), SimTime(from_s(2.0))}) {
    const Pose pose = head.at(time);
    double best_ms = 1e9;
    for (int i = 0; i < 3; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      (void)eyes.show(pose, pose);
      (void)eyes.read();
      best_ms = std::min(best_ms, to_s(SimDuration(std::chrono::steady_clock::now() - begin)) * 1e3);
    }
    slowest_ms = std::max(slowest_ms, best_ms);
  }
  return slowest_ms;
}

/// A scale, at most the session's, at which this device holds the rate. Time falls slower than the pixels
/// where a few of them take most of it, so it is measured anew at each step down.
double scale_for_rate(const gpu::Device& device, const ReplayOptions& options, const LiveCommand& command,
                      const StageRegistry& stages, const LiveHead& head) {
  const double asked =
      read_session(command.session, parse_settings(command.set), stages).device.resolution_scale;
  const double budget_ms = 0.6e3 / command.rate_hz;  // the window takes time, too
  double scale = std::min(probe_scale, asked);
  double took_ms = time_ms(device, options, command, stages, head, scale);
  if (took_ms < budget_ms) return std::min(scale * std::sqrt(budget_ms / took_ms), asked);
  for (int step = 0; step < 5 && took_ms > budget_ms && scale > scale_min; ++step) {
    scale = std::max(scale * std::min(std::sqrt(budget_ms / took_ms), 0.8), std::min(scale_min, asked));
    took_ms = time_ms(device, options, command, stages, head, scale);
  }
  return scale;
}

void print_figures(const LiveFigures& figures, double rate_hz) {
  if (figures.interval_ms.empty()) return;
  const Distribution intervals = distribution_of(figures.interval_ms);
  const auto late = std::count_if(figures.interval_ms.begin(), figures.interval_ms.end(),
                                  [&](double ms) { return ms > 1.5e3 / rate_hz; });
  fmt::print("  frames                {}, {} later than half a period at {:g} Hz\n",
             figures.interval_ms.size() + 1, late, rate_hz);
  fmt::print("  interval              p50 {:.2f}  p95 {:.2f}  p99 {:.2f}  max {:.2f} ms\n", intervals.p50,
             intervals.p95, intervals.p99, intervals.max);
  fmt::print("  cast                  p50 {:.2f} ms\n", distribution_of(figures.cast_ms).p50);
}

}  // namespace

int live_command(const LiveCommand& command) {
  note_interrupts();
  const Stages first_stages = make_stages(command.plugin_path);
  warn_of_broken(first_stages.plugins);
  Overrides overrides = parse_settings(command.set);
  const Session session = read_session(command.session, overrides, first_stages.registry);
  if (!session.compare.empty())
    throw input_error("{}: has a [compare] section; accepted by live: a session without one",
                      command.session.string());
  if (session.plan.mode == Session::Plan::Mode::automatic)
    throw input_error(
        "{}: plan.leave_out = 'auto' plans a run; accepted by live: idle, none, or the items that "
        "`brace plan` names",
        command.session.string());
  LiveWindow window(window_width_px, window_height_px, "brace live: " + session.name);
  const gpu::Device device({.select = command.gpu, .window_extensions = window.vulkan_extensions()});
  ReplayOptions options = replay_options(first_stages.registry, command.gpu);
  options.interrupted = {};  // the window's loop looks itself
  gpu::SwapChain chain(device, window.make_surface());
  LiveHead head(session, options.data_folder);
  const Pose first_pose = head.at(SimTime());
  if (!command.keep_scale) {
    const double scale = scale_for_rate(device, options, command, first_stages.registry, head);
    fmt::print(stderr, "live: resolution_scale {:.3f} for {:g} Hz on {} (--keep-scale: the session's {:g})\n",
               scale, command.rate_hz, device.info().name, session.device.resolution_scale);
    overrides.emplace_back("device.resolution_scale", fmt::format("{}", scale));
  }
  LiveEyes eyes(
      device, options,
      [&] { return read_session(command.session, overrides, make_stages(command.plugin_path).registry); },
      first_pose);

  Recorder recorder(command.record);
  LiveFigures figures;
  std::string fault;
  const auto begin = std::chrono::steady_clock::now();
  SimTime last = run_time(begin), looked = last;
  PanelPair panels;
  for (std::int64_t frame = 0; !command.frames || frame < *command.frames; ++frame) {
    if (!window.poll() || interrupted()) break;
    const SimTime now = run_time(begin);
    head.steer(window, now, to_s(now - last));
    if (window.pressed('R')) recorder.toggle();
    if (now - looked > from_s(0.2)) {
      looked = now;
      if (const auto words = eyes.reload_if_saved()) {
        fault = *words;
        fmt::print(stderr, "live: {}\n", fault.empty() ? "reloaded" : fault);
      }
    }
    const Pose render_pose = head.at(now);
    recorder.add(now, render_pose);
    figures.cast_ms.push_back(eyes.show(render_pose, head.at(run_time(begin))).cast_ms);
    panels = eyes.read();
    int width_px = 0, height_px = 0;
    window.size(width_px, height_px);
    const gpu::SwapChain::Size size = chain.fit(width_px, height_px);
    if (size.width_px > 0) (void)chain.show(fitted(side_by_side(panels), size.width_px, size.height_px));
    const SimTime shown = run_time(begin);
    if (frame > 0) figures.interval_ms.push_back(to_s(shown - last) * 1e3);
    last = shown;
    if (frame % 15 == 0) window.set_title(title_of(eyes, figures, recorder, head, fault));
    if (window.pressed('P')) write_png(fmt::format("live-{:06}.png", frame), side_by_side(panels));
  }
  recorder.write();
  if (!command.screenshot.empty() && panels[0].width_px > 0)
    write_png(command.screenshot, side_by_side(panels));
  print_figures(figures, command.rate_hz);
  return static_cast<int>(ExitCode::done);
}

}  // namespace brace
