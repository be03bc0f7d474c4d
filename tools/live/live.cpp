// brace live: the simulated headset in a window.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/core.h>
#include <unistd.h>

#include "base/error.hpp"
#include "runtime/mab/mab_plan.hpp"
#include "runtime/plan/auto_cast.hpp"
#include "runtime/replay/series_facts.hpp"
#include "runtime/timeline/wall_clock.hpp"
#include "runtime/volume/write_transfer_function.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"
#include "tools/live/head_readings.hpp"
#include "tools/live/live_eyes.hpp"
#include "tools/live/live_head.hpp"
#include "tools/live/live_scale.hpp"
#include "tools/live/overlay_figures.hpp"
#include "tools/live/stage_panel.hpp"
#include "tools/live/transfer_panel.hpp"
#include "tools/live/view_panel.hpp"
#include "tools/live/vsync_pace.hpp"
#include "tools/live/window.hpp"
#include "tools/live/window_faults.hpp"

namespace brace {

namespace {

double ms_between(SimTime from, SimTime to) {
  return to_s(to - from) * 1e3;
}

void print_figures(const FrameHistory& history, const LiveCommand& command) {
  const FrameHistory::Totals totals = history.totals();
  fmt::print("  pictures              {}, {} of them after the first second\n", history.pictures(),
             totals.pictures);
  if (!history.empty()) {
    const WorkCounts& work = history.recent().back().work;
    fmt::print("  last picture          {} rays, {} samples, {} skip steps\n", work.rays, work.samples,
               work.skip_steps);
  }
  if (totals.pictures == 0) return;
  if (command.pace != "free") {
    fmt::print("  missed vsyncs         {} of {} ({:.2f} %) at {:g} Hz\n", totals.missed,
               totals.missed + totals.pictures, totals.missed_ratio() * 100.0, command.rate_hz);
  }
  const Distribution& intervals = totals.interval_ms;
  fmt::print("  interval              p50 {:.2f}  p95 {:.2f}  p99 {:.2f}  max {:.2f} ms\n", intervals.p50,
             intervals.p95, intervals.p99, intervals.max);
  fmt::print("  cast                  p50 {:.2f}  p99 {:.2f} ms\n", totals.cast_ms.p50, totals.cast_ms.p99);
}

/// A live run: everything from the window's keys to the picture in it.
class LiveRun {
 public:
  LiveRun(const LiveCommand& command, const gpu::Device& device, LiveWindow& window, Overlay& overlay,
          LiveHead& head, LiveEyes& eyes, Overrides& overrides)
      : command_(command),
        overrides_(overrides),
        window_(window),
        overlay_(overlay),
        head_(head),
        eyes_(eyes),
        chain_(device, window.make_surface()),
        recorder_(command.record, eyes.session().name),
        pace_(rate_of_hz(command.rate_hz)) {
    facts_.session = eyes.session().name;
    facts_.device = device.info().name;
    facts_.rate_hz = command.rate_hz;
    if (const std::string refusal = eyes.set_view(*view_of(command.view)); !refusal.empty())
      throw input_error("--view: {}", refusal);
  }

  void run() {
    note_window_faults([&] { recorder_.write(); });
    try {
      show_frames();
    } catch (...) {
      recorder_.write();  // what was done by hand is not to be had again
      int width_px = 0, height_px = 0;
      window_.size(width_px, height_px);  // asks the window system; a window that is gone is a fault
      note_window_faults({});
      throw_if_taken_away();
      throw;
    }
    finish();
    note_window_faults({});
  }

 private:
  static void throw_if_taken_away() {
    if (const std::string fault = window_fault(); !fault.empty())
      throw device_error("live: the window was taken away by another program ({})", fault);
  }

  void show_frames() {
    for (; !command_.frames || frame_ < *command_.frames; ++frame_) {
      if (!window_.poll(overlay_on_ && overlay_.wants_mouse(), overlay_on_ && overlay_.wants_keys())) break;
      if (interrupted()) break;
      throw_if_taken_away();
      take_keys();
      reload();
      show_frame();
      set_title();
      if (window_.pressed('P')) write_pictures();
    }
  }

  void finish() {
    recorder_.write();
    if (!command_.screenshot.empty() && panels_[0].width_px > 0)
      write_png(command_.screenshot, side_by_side(panels_));
    if (!command_.window_screenshot.empty() && picture_.width_px > 0)
      write_png(command_.window_screenshot, picture_);
    print_figures(history_, command_);
    if (const std::string words = eyes_.legend().words; !words.empty())
      fmt::print("  view                  {}: {}\n", name_of(eyes_.view()), words);
  }

  void write_pictures() {
    try {
      write_pictures_of_frame();
    } catch (const Error& error) {
      tell(error.what(), "", clock_.now());  // as a full disk: the head may be being recorded
    }
  }

  void write_pictures_of_frame() const {
    const std::string name = fmt::format("live-{:06}", frame_);
    const bool other = eyes_.view() != ViewKind::picture;
    write_png(name + (other ? fmt::format("-{}.png", name_of(eyes_.view())) : ".png"), side_by_side(panels_));
    if (picture_.width_px > 0) write_png(name + "-window.png", picture_);
  }

  void take_keys() {
    const SimTime now = clock_.now();
    const bool was_by_hand = head_.by_hand();
    head_.steer(window_, now, to_s(now - steered_));
    if (was_by_hand && !head_.by_hand()) readings_.forget();  // back on the trace in one jump
    steered_ = now;
    if (window_.pressed('R')) recorder_.toggle();
    if (window_.pressed('H')) {
      overlay_on_ = !overlay_on_;
      overlay_due_ = true;
    }
    for (std::size_t i = 0; i < view_names.size(); ++i)
      if (window_.pressed(static_cast<char>('1' + i))) set_view(static_cast<ViewKind>(i));
  }

  void reload() {
    if (clock_.now() - looked_ < from_s(0.2)) return;
    looked_ = clock_.now();
    const SimTime before = looked_;
    const auto words = eyes_.reload_if_saved();
    if (!words) return;
    tell(*words, "reloaded", before);
  }

  /// What became of a change that began then; `fault` is empty when it was made.
  void tell(const std::string& fault, const std::string& done, SimTime began) {
    facts_.fault = fault;
    if (!fault.empty()) overlay_on_ = true;
    overlay_due_ = true;
    facts_.message = fmt::format("{} in {:.0f} ms", done, ms_between(began, clock_.now()));
    fmt::print(stderr, "live: {}\n", fault.empty() ? facts_.message : fault);
  }

  /// The session with another setting; the one before stays in force where that is refused.
  void apply(const Setting& setting) {
    const SimTime began = clock_.now();
    const Overrides before = overrides_;
    std::erase_if(overrides_, [&](const auto& entry) { return entry.first == setting.key; });
    overrides_.emplace_back(setting.key, setting.value);
    const std::string refusal = eyes_.remake();
    if (!refusal.empty()) overrides_ = before;
    const std::string done = setting.key + " = " + setting.value;
    tell(refusal.empty() ? refusal : done + " is refused: " + refusal, done, began);
  }

  void set_view(ViewKind kind) {
    const SimTime began = clock_.now();
    tell(eyes_.set_view(kind), fmt::format("view {}", name_of(kind)), began);
  }

  void show_frame() {
    LiveFrame frame;
    const SimTime render_time = clock_.now();
    recorder_.add(render_time, head_);
    // It will be seen about as long after its poses were taken as the last one was.
    const LiveFrame last = history_.empty() ? LiveFrame() : history_.recent().back();
    SimTime warp_time{};
    const LiveEyes::Times times = eyes_.show(pose_for(render_time, last.frame_age_ms, true), [&] {
      warp_time = clock_.now();
      return pose_for(warp_time, last.mtp_rotation_ms, false);
    });
    frame.costs = {times.opening_ms, times.cast_ms, times.closing_ms, times.warp_ms};
    frame.work = times.work;
    const SimTime warped = clock_.now();
    panels_ = eyes_.read();
    const SimTime read = clock_.now();
    panels_ = eyes_.viewed(std::move(panels_));
    const SimTime viewed = clock_.now();
    const bool loaded = fill_window();
    const SimTime filled = clock_.now();
    frame.costs.read = ms_between(warped, read);
    frame.costs.view = ms_between(read, viewed);
    frame.costs.paint = ms_between(viewed, filled);
    present(frame, loaded, filled);
    const WarpPose warp_pose = warp_pose_of(eyes_.session().pipeline.at("warp"));
    frame.mtp_rotation_ms = ms_between(warp_pose == WarpPose::none ? render_time : warp_time, frame.shown);
    frame.mtp_translation_ms =
        ms_between(warp_pose == WarpPose::rotation_and_translation ? warp_time : render_time, frame.shown);
    frame.frame_age_ms = ms_between(render_time, frame.shown);
    history_.add(frame);
    control(frame);
  }

  Pose pose_for(SimTime now, double ahead_ms, bool for_cast) {
    // A head by hand moves when the window is asked, once per picture.
    if (!head_.by_hand() || readings_.all().empty() || for_cast) readings_.add(now, head_.at(now));
    return eyes_.predicted(readings_.all(), now + from_s(ahead_ms * 1e-3));
  }

  /// What the host and the warp leave of a period is the cast's budget.
  void control(const LiveFrame& frame) {
    const LiveCosts& costs = frame.costs;
    const double cast_ms = costs.opening + costs.cast + costs.closing;
    const double other_ms = costs.warp + costs.view + costs.read + costs.paint + costs.present;
    eyes_.control(from_s(cast_ms * 1e-3), from_s(1.0 / command_.rate_hz - other_ms * 1e-3), frame.missed);
  }

  /// False where the window has no pixels, or other ones than a moment ago.
  bool fill_window() {
    int width_px = 0, height_px = 0;
    window_.size(width_px, height_px);
    const gpu::SwapChain::Size size = chain_.fit(width_px, height_px);
    if (size.width_px == 0) return false;
    if (picture_.width_px != size.width_px || picture_.height_px != size.height_px) {
      picture_ = ImageRgba8(size.width_px, size.height_px);
      overlay_due_ = true;
    }
    const WindowLayout layout = lay_out(size.width_px, size.height_px, overlay_on_);
    draw_fitted(side_by_side(panels_), layout.eyes, picture_);
    // Beside the eyes it stays as it is drawn: often enough to read is enough.
    const bool touched = overlay_.wants_mouse() && window_.mouse_in_use();
    overlay_due_ = overlay_due_ || touched || clock_.now() - overlaid_ >= from_s(1.0 / 30.0);
    if (overlay_on_ && overlay_due_) draw_overlay(layout);
    return chain_.load(picture_);
  }

  void draw_overlay(const WindowLayout& layout) {
    facts_.head = head_.by_hand() ? "by hand (T: trace)" : "trace";
    facts_.eye_width_px = eyes_.headset().eye.width_px;
    facts_.eye_height_px = eyes_.headset().eye.height_px;
    facts_.recording = recorder_.on();
    window_.feed_overlay();
    const SimTime now = clock_.now();
    overlay_.begin(picture_.width_px, picture_.height_px, to_s(now - overlaid_));
    overlaid_ = now;
    overlay_due_ = false;
    std::optional<Setting> setting;
    std::optional<ViewKind> view;
    TransferPanel::Change change;
    if (overlay_.begin_panel("column", layout.column)) {
      facts_panel(facts_, history_);
      view = view_panel(overlay_, eyes_.view(), eyes_.legend());
      figures_panel(overlay_, facts_, history_);
      if (overlay_.heading("Stages"))
        setting = stages_.show(overlay_, eyes_.session().pipeline, eyes_.stages(), stage_notes());
      if (overlay_.heading("Transfer"))
        change =
            transfer_.show(overlay_, eyes_.transfer(), eyes_.scene().statistics, eyes_.scene().table.range);
    }
    overlay_.end_panel();
    timeline_panel(overlay_, facts_, history_, layout.strip);
    overlay_.end(picture_);
    write_widgets();
    if (setting) apply(*setting);
    if (view) set_view(*view);
    take_transfer(change);
  }

  void take_transfer(const TransferPanel::Change& change) {
    const SimTime began = clock_.now();
    if (change.edited) {
      eyes_.set_transfer(*change.edited);
      facts_.message = fmt::format("transfer function edited in {:.1f} ms", ms_between(began, clock_.now()));
    }
    if (change.save_as.empty()) return;
    std::string fault;
    try {
      write_transfer_function(change.save_as, eyes_.transfer());
    } catch (const Error& error) {
      fault = error.what();
    }
    tell(fault, "transfer function in " + change.save_as + ", written", began);
  }

  std::map<std::string, std::string> stage_notes() const {
    std::map<std::string, std::string> notes;
    notes["schedule"] = "no effect in the window: each picture is cast in one piece";
    notes["control"] = eyes_.session().pipeline.at("rays").stage.id() == "rays/mab"
                           ? fmt::format("casts {:.0f} % of the rays", 100.0 * eyes_.quality())
                           : "no effect: these rays are the same at every quality";
    if (!history_.empty())
      notes["predict"] = fmt::format("{:.0f} ms ahead", history_.recent().back().frame_age_ms);
    const SceneOnDevice& scene = eyes_.scene();
    if (!scene.skip_reason.empty()) notes["skip"] = scene.skip_stage.stage.id() + ": " + scene.skip_reason;
    return notes;
  }

  void write_widgets() {
    if (command_.widgets.empty()) return;
    const std::string places = places_text(overlay_.places());
    if (places == widgets_) return;
    widgets_ = places;
    const std::string fresh = command_.widgets + ".new";
    std::ofstream(fresh) << places;
    std::filesystem::rename(fresh, command_.widgets);  // whole, or not at all
  }

  void set_title() {
    if (clock_.now() - titled_ < from_s(0.5)) return;
    titled_ = clock_.now();
    std::string title = fmt::format("brace live: {} - {:.0f} fps", facts_.session, history_.rate_hz());
    if (recorder_.on()) title += ", recording";
    if (!facts_.fault.empty()) title += " - " + facts_.fault;
    std::replace(title.begin(), title.end(), '\n', ' ');
    window_.set_title(title);
  }

  void present(LiveFrame& frame, bool loaded, SimTime ready) {
    if (command_.pace == "simulated") {
      const VsyncPace::Slot slot = pace_.take(ready);
      clock_.wait_until(slot.vsync);
      frame.missed = slot.missed;
    }
    const SimTime begin = clock_.now();
    if (loaded) (void)chain_.present();
    frame.shown = clock_.now();
    frame.costs.present = ms_between(begin, frame.shown);
    if (history_.empty()) return;
    frame.interval_ms = ms_between(history_.recent().back().shown, frame.shown);
    if (command_.pace == "window")
      frame.missed = missed_in(frame.shown - history_.recent().back().shown, rate_of_hz(command_.rate_hz));
  }

  const LiveCommand& command_;
  Overrides& overrides_;  // that the eyes' session is read with
  LiveWindow& window_;
  Overlay& overlay_;
  LiveHead& head_;
  LiveEyes& eyes_;
  gpu::SwapChain chain_;
  Recorder recorder_;
  VsyncPace pace_;
  HostClock clock_;
  FrameHistory history_;
  OverlayFacts facts_;
  HeadReadings readings_;
  StagePanel stages_;
  TransferPanel transfer_{"live-transfer.toml"};
  std::string widgets_;  // last written
  bool overlay_on_ = true, overlay_due_ = true;
  SimTime steered_{}, looked_{}, overlaid_{}, titled_{};
  std::int64_t frame_ = 0;
  PanelPair panels_;
  ImageRgba8 picture_;  // the window's
};

Session first_session(const LiveCommand& command, const Overrides& overrides, const StageRegistry& stages) {
  Session session = read_session(command.session, overrides, stages);
  if (!session.compare.empty())
    throw input_error("{}: has a [compare] section; accepted by live: a session without one",
                      command.session.string());
  if (session.plan.mode == Session::Plan::Mode::automatic)
    throw input_error(
        "{}: plan.leave_out = 'auto' plans a run; accepted by live: idle, none, or the items that "
        "`brace plan` names",
        command.session.string());
  if (const PipelineStage& rays = session.pipeline.at("rays");
      rays.stage.id() == "rays/mab" && mab_settings(rays).gaze != MabGaze::fixed)
    throw input_error(
        "{}: rays/mab follows a gaze, but live does not know where you look; accepted by live: "
        "stage.mab.gaze = 'fixed'",
        command.session.string());
  return session;
}

/// What is written at the end must not fail there.
void check_folders(const LiveCommand& command) {
  const std::pair<const char*, const std::string&> files[] = {
      {"--record", command.record},
      {"--screenshot", command.screenshot},
      {"--screenshot-window", command.window_screenshot},
      {"--widgets", command.widgets}};
  for (const auto& [option, file] : files) {
    if (file.empty()) continue;
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    if (::access(folder.c_str(), W_OK | X_OK) != 0 || std::filesystem::is_directory(file))
      throw input_error(
          "{} {}: cannot be written there; accepted: a file in a folder that exists and can be written",
          option, file);
  }
}

bool say_validation_faults(const gpu::Device& device) {
  const std::vector<std::string>& messages = device.validation_messages();
  if (!messages.empty())
    fmt::print(stderr, "brace: the validation layers found a fault: {}\n", messages.front());
  return !messages.empty();
}

}  // namespace

int live_command(const LiveCommand& command) {
  note_interrupts();
  check_folders(command);
  const Stages first_stages = make_stages(command.plugin_path);
  warn_of_broken(first_stages.plugins);
  Overrides overrides = parse_settings(command.set);
  const SessionReader read = [&](const Overrides& more) {
    Overrides all = overrides;
    all.insert(all.end(), more.begin(), more.end());
    return read_session(command.session, all, first_stages.registry);
  };
  for (const auto& setting :
       decide_cast(read, first_stages.registry, replay_options(first_stages.registry, command.gpu)).settings)
    overrides.push_back(setting);
  const Session session = first_session(command, overrides, first_stages.registry);
  Overlay overlay;
  LiveWindow window(command.window_px[0], command.window_px[1], "brace live: " + session.name);
  window.attach_overlay();
  const gpu::Device device({.select = command.gpu, .window_extensions = window.vulkan_extensions()});
  ReplayOptions options = replay_options(first_stages.registry, command.gpu);
  options.interrupted = {};  // the window's loop looks itself
  LiveHead head(session, options.data_folder);
  const Pose first_pose = head.at(SimTime());
  if (!command.keep_scale) {
    const LiveScale found = scale_for_rate(device, options, command, first_stages.registry, head, window);
    fmt::print(stderr,
               "live: resolution_scale {:.3f} for {:g} Hz on {}: eyes {:.1f} ms, window {:.1f} ms of {:.1f} "
               "(--keep-scale: the session's {:g})\n",
               found.scale, command.rate_hz, device.info().name, found.eyes_ms, found.window_ms,
               1e3 / command.rate_hz, session.device.resolution_scale);
    if (!found.holds)
      fmt::print(stderr,
                 "live: {:g} Hz will hardly be held here; a lower --rate or a smaller --window will\n",
                 command.rate_hz);
    overrides.emplace_back("device.resolution_scale", fmt::format("{}", found.scale));
  }
  LiveEyes eyes(
      device, options,
      [&] {
        const StageRegistry registry = make_stages(command.plugin_path).registry;
        return LiveEyes::Read{read_session(command.session, overrides, registry), registry.stages()};
      },
      first_pose);
  try {
    LiveRun run(command, device, window, overlay, head, eyes, overrides);
    run.run();
  } catch (const Error&) {
    say_validation_faults(device);
    throw;
  }
  if (say_validation_faults(device)) return static_cast<int>(ExitCode::device_or_plugin_failed);
  return static_cast<int>(ExitCode::done);
}

}  // namespace brace
