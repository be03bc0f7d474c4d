#include <algorithm>
#include <functional>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/replay/replay.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"
#include "tools/live/view_colours.hpp"

namespace {

/// An empty variable in a script must not mean the default, which may be there already.
std::string not_empty(const std::string& folder) {
  return folder.empty() ? "is empty; accepted: a folder" : "";
}

using namespace brace;

constexpr int sweep_jobs_max = 1024;

/// What to do once the command line is parsed.
using Action = std::function<int()>;

void add_gpu_option(CLI::App& app, std::string& gpu) {
  app.add_option("--gpu", gpu,
                 "Vulkan device: a part of its name, its index or its UUID (see `brace doctor`)");
}

void add_plugin_path_option(CLI::App& app, std::vector<std::string>& plugin_path) {
  app.add_option("--plugin-path", plugin_path,
                 "Where to look for stages of others: a folder, a shared library or a stage.toml; repeatable")
      ->allow_extra_args(false);
}

void add_item_options(CLI::App& app, std::vector<std::string>& keep, std::vector<std::string>& leave_out) {
  app.add_option("--keep", keep, "ITEM: keep it whatever the planner finds, e.g. warp; repeatable")
      ->allow_extra_args(false);
  app.add_option("--leave-out", leave_out, "ITEM: do without it, e.g. shading; repeatable")
      ->allow_extra_args(false);
}

void add_run(CLI::App& app, RunCommand& command, Action& action) {
  CLI::App* run =
      app.add_subcommand("run", "Replay a session on the simulated headset and write a run directory");
  run->add_option("session", command.session, "Session file (TOML)")->required();
  run->add_option("--set", command.set,
                  "KEY=VALUE: override a key of the session, e.g. device.profile=valve-index");
  run->add_option("--out", command.out, "Run directory to write (default: runs/SESSION)")->check(not_empty);
  run->add_option("--frames", command.frames, "Number of display vsyncs (default: to the end of the trace)");
  run->add_option("--seed", command.seed, "Seed of the tracker's noise");
  run->add_option("--watchdog", command.watchdog,
                  "Watch what stages do: outputs (results and deadlines), full (and memory), off");
  run->add_flag("--plan", command.plan, "Leave out what the planner finds is not needed: see `brace plan`");
  add_item_options(*run, command.keep, command.leave_out);
  add_gpu_option(*run, command.gpu);
  add_plugin_path_option(*run, command.plugin_path);
  run->add_flag("--json", command.json, "Print the summary as JSON");
  run->footer(
      "Example:\n  brace run examples/demo.toml --set pipeline.warp=none --frames 180 --out runs/no-warp");
  run->callback([&] { action = [&] { return run_command(command); }; });
}

void add_plan(CLI::App& app, PlanCommand& command, Action& action) {
  CLI::App* plan =
      app.add_subcommand("plan", "What of a session's pipeline does its scene not need, and why");
  plan->add_option("session", command.session, "Session file (TOML)")->required();
  plan->add_option("--set", command.set, "KEY=VALUE: override a key of the session");
  add_item_options(*plan, command.keep, command.leave_out);
  plan->add_option("--frames", command.frames, "Number of display vsyncs of the check");
  plan->add_flag("--check", command.check,
                 "Replay the session as given and as planned; exit code 1 if the plan was wrong");
  plan->add_option("--out", command.out, "Run directory of the check (default: runs/SESSION-plan)")
      ->check(not_empty);
  add_gpu_option(*plan, command.gpu);
  add_plugin_path_option(*plan, command.plugin_path);
  plan->add_flag("--json", command.json, "Print JSON");
  plan->footer(
      "Items: shading, preintegration, early_termination, skip, stereo, rays, warp, distortion,\n"
      "chromatic_channels, scan_out_correction; their rules stand in docs/planning.md.\n\n"
      "Example:\n  brace plan examples/plan_everything.toml --check");
  plan->callback([&] { action = [&] { return plan_command(command); }; });
}

void add_compare(CLI::App& app, CompareCommand& command, Action& action) {
  CLI::App* compare = app.add_subcommand("compare", "Is run or sweep B worse than A? Exit code 1 if so");
  compare->add_option("a", command.a, "Run directory, or sweep folder, to compare with: the baseline")
      ->required();
  compare->add_option("b", command.b, "Run directory, or sweep folder, under test")->required();
  compare
      ->add_option("--tolerance", command.tolerances,
                   "FIGURE=VALUE: how much worse it may be, in its own unit or as a share (5%); repeatable")
      ->allow_extra_args(false);
  compare->add_option("--confidence", command.confidence, "Of the interval of each difference")
      ->check(CLI::Range(0.5, 0.9999))
      ->capture_default_str();
  compare->add_option("--resamples", command.resamples, "Bootstrap resamples")
      ->check(CLI::Range(100, 1'000'000))
      ->capture_default_str();
  compare->add_option("--seed", command.seed, "Seed of the bootstrap")->capture_default_str();
  compare->add_flag("--json", command.json, "Print JSON");
  compare->footer("Example:\n  brace compare baseline runs/demo --tolerance mtp_rotation_ms.p99=5%");
  compare->callback([&] { action = [&] { return compare_command(command); }; });
}

void add_sweep(CLI::App& app, SweepCommand& command, Action& action) {
  CLI::App* sweep =
      app.add_subcommand("sweep", "Run a session at many points; goes on where an earlier call was stopped");
  sweep->add_option("file", command.file, "Sweep file (TOML): see docs/sweeps.md")->required();
  sweep->add_option("--out", command.out, "Folder for results.sqlite and results.csv (default: sweeps/FILE)")
      ->check(not_empty);
  command.jobs = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, sweep_jobs_max);
  sweep
      ->add_option("--jobs", command.jobs, "Runs at a time (default: one per core); measured costs run alone")
      ->check(CLI::Range(1, sweep_jobs_max));
  sweep->add_flag("--retry-failed", command.retry_failed, "Run again what has failed or crashed");
  sweep->add_flag("--keep-runs", command.keep_runs, "Keep every run directory in runs/");
  add_gpu_option(*sweep, command.gpu);
  add_plugin_path_option(*sweep, command.plugin_path);
  sweep->add_flag("--json", command.json, "Print the counts as JSON");
  sweep->footer("Example:\n  brace sweep examples/sweep_step.toml --out sweeps/step");
  sweep->callback([&] { action = [&] { return sweep_command(command); }; });
}

void add_live(CLI::App& app, LiveCommand& command, Action& action) {
  CLI::App* live = app.add_subcommand("live", "The simulated headset in a window, on the trace or by hand");
  live->add_option("session", command.session, "Session file (TOML)")->required();
  live->add_option("--set", command.set, "KEY=VALUE: override a key of the session");
  live->add_option("--rate", command.rate_hz,
                   "Vsyncs per second, and pictures that the resolution is chosen for")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  live->add_flag("--keep-scale", command.keep_scale,
                 "Keep the session's resolution_scale, whatever the rate");
  live->add_option("--frames", command.frames, "End after this many pictures (default: until closed)")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40));
  live->add_option("--screenshot", command.screenshot, "PNG of both eyes to write at the end");
  live->add_option("--screenshot-window", command.window_screenshot,
                   "PNG of the window to write at the end, overlay and all");
  live->add_option(
      "--widgets", command.widgets,
      "Text file to keep the places of the overlay's widgets in (x y width height name), for scripts");
  live->add_option("--window", command.window_px, "Width and height of the window at first, pixels")
      ->expected(2)
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  live->add_option(
          "--view", command.view,
          "What is shown of the eyes: the picture, its difference or dssim from the ideal one, levels of "
          "rays/mab, skip_steps or samples of each ray, depth of its first visible sample")
      ->check(CLI::IsMember(std::vector<std::string>(view_names.begin(), view_names.end())))
      ->capture_default_str();
  live->add_option("--pace", command.pace,
                   "What pictures wait for: vsyncs at --rate, those of the window's display, or nothing")
      ->check(CLI::IsMember({"simulated", "window", "free"}))
      ->capture_default_str();
  live->add_option("--record", command.record, "Trace of the head to write at the end (without it: key R)");
  add_gpu_option(*live, command.gpu);
  add_plugin_path_option(*live, command.plugin_path);
  live->footer(
      "Keys: drag with the mouse to look, WASD or arrows to move, Q and E down and up, T back to the trace,\n"
      "R record (live.trace), P pictures (live-FRAME.png and -window.png), H hides the overlay,\n"
      "1 to 7 choose the view, Esc ends. Saved stages are compiled and swapped in.\n\n"
      "Example:\n  brace live examples/demo.toml\n"
      "  xvfb-run brace live examples/demo.toml --frames 60 --screenshot eyes.png");
  live->callback([&] { action = [&] { return live_command(command); }; });
}

void add_list(CLI::App& app, ListCommand& command, Action& action) {
  CLI::App* list = app.add_subcommand("list", "What sessions can name");
  list->add_option("what", command.what,
                   "devices, stages, plugins, generators, costs, transfer-functions, traces or keys")
      ->required();
  add_plugin_path_option(*list, command.plugin_path);
  list->add_flag("--json", command.json, "Print JSON");
  list->footer("Example:\n  brace list stages");
  list->callback([&] { action = [&] { return list_command(command); }; });
}

void add_doctor(CLI::App& app, DoctorCommand& command, Action& action) {
  CLI::App* doctor = app.add_subcommand("doctor", "Check this machine: Vulkan devices, data files, caches");
  add_gpu_option(*doctor, command.gpu);
  doctor->add_flag("--measure-again", command.measure_again,
                   "Measure data paths and raycasters anew instead of showing what is kept");
  doctor->add_flag("--json", command.json, "Print JSON");
  doctor->footer("Example:\n  brace doctor");
  doctor->callback([&] { action = [&] { return doctor_command(command); }; });
}

struct TraceCommands {
  TraceInfoCommand info;
  TraceConvertCommand convert;
  TraceGenerateCommand generate;
};

void add_trace(CLI::App& app, TraceCommands& commands, Action& action) {
  CLI::App* trace = app.add_subcommand("trace", "Look at, convert and generate head pose traces");
  trace->require_subcommand(1);
  trace->footer("Example:\n  brace trace info my_recording.csv");

  CLI::App* info = trace->add_subcommand("info", "Length, rate, speeds, gaze and repairs of a trace");
  info->add_option("file", commands.info.file, "Trace (TUM, EuRoC, A-Frame JSON or Brace's own form)")
      ->required();
  info->add_flag("--strict", commands.info.strict, "Refuse a trace that would need repair");
  info->add_flag("--json", commands.info.json, "Print JSON");
  info->footer("Example:\n  brace trace info my_recording.csv");
  info->callback([&] { action = [&] { return trace_info_command(commands.info); }; });

  CLI::App* convert = trace->add_subcommand("convert", "Write a trace in another form");
  convert->add_option("from", commands.convert.from, "Trace to read")->required();
  convert->add_option("to", commands.convert.to, "File to write")->required();
  convert->add_option("--format", commands.convert.format,
                      "brace, tum or euroc (default: by the extension: .trace, .txt, .csv)");
  convert->footer("Example:\n  brace trace convert recording.json recording.trace");
  convert->callback([&] { action = [&] { return trace_convert_command(commands.convert); }; });

  CLI::App* generate = trace->add_subcommand("generate", "Make a head motion through the neck model");
  generate
      ->add_option("motion", commands.generate.motion,
                   "rotation, translation, natural, still, spin or inspect")
      ->required();
  generate->add_option("to", commands.generate.to, "File to write")->required();
  generate->add_option("--degrees", commands.generate.degrees,
                       "Extent of a rotation; speed per second of a spin");
  generate->add_option("--metres", commands.generate.metres, "Extent of a translation");
  generate->add_option("--seconds", commands.generate.seconds, "Duration");
  generate->add_option("--rate", commands.generate.rate_hz, "Poses per second");
  generate->add_option("--seed", commands.generate.seed, "Seed of the natural motion, and of the eyes");
  generate->add_option("--gaze", commands.generate.gaze, "What the eyes do: none, saccades or pursuit");
  generate->add_option("--blinks", commands.generate.blinks_per_minute,
                       "Blinks per minute, in which the eye tracker loses the eyes");
  generate->footer("Example:\n  brace trace generate rotation turn.trace --degrees 60 --seconds 1");
  generate->callback([&] { action = [&] { return trace_generate_command(commands.generate); }; });
}

void add_bench(CLI::App& app, BenchCommand& command, Action& action) {
  CLI::App* bench =
      app.add_subcommand("bench", "Measure this machine against published and installed rivals");
  bench
      ->add_option("name", command.name,
                   "raycast, replay, distort, skip, costs, host, integrators, mab, plan, scaling, schedule, "
                   "stereo or warp")
      ->required();
  add_gpu_option(*bench, command.gpu);
  bench->add_flag("--quick", command.quick, "Fewer repetitions: a first look, not a figure to quote");
  bench->add_flag("--json", command.json, "Print JSON");
  bench->add_option("--scene", command.scenes, "skip: head, insect, snake or none; may be given again")
      ->take_all();
  bench
      ->add_option(
          "--part", command.parts,
          "skip: updates, frames, threshold or octants; stereo: methods, shading, layers or resolution; "
          "mab: atlases, errors, times or controls; scaling: threads, image, volume or empty; may be given "
          "again")
      ->take_all();
  bench
      ->add_option("--volume", command.volumes,
                   "skip: a file or generator for frames beside the scenes; mab, plan, stereo: the volumes")
      ->take_all();
  bench->add_option("--partitions", command.partitions, "skip: numbers of partitions")
      ->take_all()
      ->check(CLI::Range(1, 256));
  bench->add_option("--viewport", command.viewport_px, "skip: edge of the picture in pixels")
      ->check(CLI::Range(8, 4096))
      ->capture_default_str();
  bench->add_option("--out", command.out, "skip: folder for the table and the plots");
  bench->footer("Example:\n  brace bench raycast\n  brace bench skip --scene head --out skip-bench");
  bench->callback([&] { action = [&] { return bench_command(command); }; });
}

void add_verify(CLI::App& app, VerifyCommand& command, Action& action) {
  CLI::App* verify =
      app.add_subcommand("verify", "Verify the numerics: each claim with its figure and bound");
  verify->add_option(
      "groups", command.groups,
      "integrators, adaptive, stability, absorption, skipping, extremes, lenses, motion, stereo, control, "
      "schedule (default: all)");
  verify->add_option("--out", command.out, "Folder to write report.html into");
  add_gpu_option(*verify, command.gpu);
  verify->add_flag("--json", command.json, "Print JSON");
  verify->footer("Example:\n  brace verify --out runs/verify");
  verify->callback([&] { action = [&] { return verify_command(command); }; });
}

void add_new_stage(CLI::App& app, NewStageCommand& command, Action& action) {
  CLI::App* stage = app.add_subcommand("new-stage", "Write a small project for a stage of your own");
  stage
      ->add_option("kind", command.kind, "cast, rays, skip or warp (GLSL); cast, predict or control (native)")
      ->required();
  stage->add_option("name", command.name, "Name of the stage, snake_case")->required();
  stage->add_flag("--glsl", command.glsl, "A GLSL snippet with a manifest");
  stage->add_flag("--native", command.native, "A shared library in C");
  stage->add_option("--out", command.out, "Folder to write (default: ./NAME)");
  stage->footer("Example:\n  brace new-stage cast my_cast --glsl");
  stage->callback([&] { action = [&] { return new_stage_command(command); }; });
}

void add_check_stage(CLI::App& app, CheckStageCommand& command, Action& action) {
  CLI::App* check = app.add_subcommand("check-stage", "Run the conformance suite on a stage");
  check
      ->add_option("file", command.file, "A stage.toml, a shared library, a folder with them, or FAMILY/NAME")
      ->required();
  add_gpu_option(*check, command.gpu);
  add_plugin_path_option(*check, command.plugin_path);
  check->add_flag("--json", command.json, "Print JSON");
  check->footer("Example:\n  brace check-stage my_cast/stage.toml");
  check->callback([&] { action = [&] { return check_stage_command(command); }; });
}

/// CLI11 says only that a command is missing.
void check_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({}))
    names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return;
  throw input_error("there is no command '{}'{}; accepted: {}", argv[1], did_you_mean(argv[1], names),
                    join(names));
}

int run_action(const Action& action) {
  try {
    return action();
  } catch (const Error& e) {
    fmt::print(stderr, "brace: {}\n", e.what());
    return static_cast<int>(e.exit_code());
  } catch (const Interrupted&) {
    fmt::print(stderr, "brace: interrupted; no run directory was written\n");
    end_by_noted_signal();
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "brace: out of memory: take a smaller volume or device.resolution_scale\n");
    return static_cast<int>(ExitCode::device_or_plugin_failed);
  } catch (const std::exception& e) {
    fmt::print(stderr, "brace: {}\n", e.what());
    return static_cast<int>(ExitCode::device_or_plugin_failed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Brace: a simulated head-mounted display for volume renderers", "brace");
  app.set_version_flag("--version", BRACE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Example:\n  brace run examples/demo.toml --out runs/demo\n\n"
      "Exit codes: 0 done, 1 a check failed, 2 bad input or usage, 3 device, disk or plug-in failed.");

  RunCommand run;
  PlanCommand plan;
  LiveCommand live;
  CompareCommand compare;
  SweepCommand sweep;
  ListCommand list;
  DoctorCommand doctor;
  TraceCommands trace;
  BenchCommand bench;
  VerifyCommand verify;
  NewStageCommand new_stage;
  CheckStageCommand check_stage;
  Action action;
  add_run(app, run, action);
  add_plan(app, plan, action);
  add_live(app, live, action);
  add_compare(app, compare, action);
  add_sweep(app, sweep, action);
  add_trace(app, trace, action);
  add_list(app, list, action);
  add_doctor(app, doctor, action);
  add_bench(app, bench, action);
  add_verify(app, verify, action);
  add_new_stage(app, new_stage, action);
  add_check_stage(app, check_stage, action);

  return run_action([&] {
    check_command(app, argc, argv);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
    }
    return action();
  });
}
