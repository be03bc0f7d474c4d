#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/host/plugin_library.hpp"
#include "runtime/replay/replay.hpp"
#include "runtime/session/session.hpp"

namespace brace {

// The commands of `brace`. Each returns the exit code or throws brace::Error; main() prints it.

/// The values of --set. Throws input_error for one that is not KEY=VALUE.
Overrides parse_settings(const std::vector<std::string>& settings);

struct RunCommand {
  std::filesystem::path session;
  std::vector<std::string> set;  // KEY=VALUE
  std::string out;               // "" for runs/SESSION
  std::optional<std::int64_t> frames;
  std::optional<std::uint64_t> seed;
  std::optional<std::string> watchdog;
  bool plan = false;                         // leave out what the planner finds is not needed
  std::vector<std::string> keep, leave_out;  // items
  std::string gpu;
  std::vector<std::string> plugin_path;
  bool json = false;
};
int run_command(const RunCommand& command);

struct PlanCommand {
  std::filesystem::path session;
  std::vector<std::string> set;              // KEY=VALUE
  std::vector<std::string> keep, leave_out;  // items
  std::optional<std::int64_t> frames;
  bool check = false;  // replay both ways
  std::string out;     // of the check; "" for runs/SESSION-plan
  std::string gpu;
  std::vector<std::string> plugin_path;
  bool json = false;
};
int plan_command(const PlanCommand& command);

/// plan.keep and plan.leave_out from --keep, --leave-out and --plan, where they were given.
Overrides plan_settings(const std::vector<std::string>& keep, const std::vector<std::string>& leave_out,
                        bool automatic);

/// What replay() is given by commands.
ReplayOptions replay_options(const StageRegistry& stages, const std::string& gpu);

struct LiveCommand {
  std::filesystem::path session;
  std::vector<std::string> set;  // KEY=VALUE
  std::optional<std::int64_t> frames;
  std::string screenshot;  // PNG of the last frame; "": none
  std::string record;      // trace to write; "": only when asked to
  double rate_hz = 30.0;
  bool keep_scale = false;
  std::string gpu;
  std::vector<std::string> plugin_path;
  std::string window_screenshot;             // PNG of the last window, overlay and all; "": none
  std::string widgets;                       // file to keep the places of the overlay's widgets in; "": none
  std::vector<int> window_px = {1200, 640};  // width and height at first
  std::string view = "picture";
  std::string pace = "simulated";  // simulated | window | free: whose vsyncs pictures wait for
};
int live_command(const LiveCommand& command);

struct CompareCommand {
  std::filesystem::path a, b;           // run directories
  std::vector<std::string> tolerances;  // FIGURE=VALUE
  double confidence = 0.95;
  int resamples = 1000;
  std::uint64_t seed = 1;
  bool json = false;
};
int compare_command(const CompareCommand& command);
struct SweepCommand {
  std::filesystem::path file;
  std::string out;  // "" for sweeps/FILE
  int jobs = 1;
  bool retry_failed = false, keep_runs = false;
  std::string gpu;
  std::vector<std::string> plugin_path;
  bool json = false;
};
int sweep_command(const SweepCommand& command);

struct ListCommand {
  std::string what;  // devices, stages, plugins, generators, costs, transfer-functions, traces, keys
  std::vector<std::string> plugin_path;
  bool json = false;
};
int list_command(const ListCommand& command);

struct DoctorCommand {
  std::string gpu;
  bool measure_again = false;  // instead of showing what is kept
  bool json = false;
};
int doctor_command(const DoctorCommand& command);

struct TraceInfoCommand {
  std::filesystem::path file;
  bool strict = false;
  bool json = false;
};
int trace_info_command(const TraceInfoCommand& command);

struct TraceConvertCommand {
  std::filesystem::path from, to;
  std::string format;  // "" by the extension: .trace brace, .txt tum, .csv euroc
};
int trace_convert_command(const TraceConvertCommand& command);

struct TraceGenerateCommand {
  std::string motion;
  std::filesystem::path to;
  double degrees = 60.0, metres = 0.3, seconds = 1.0, rate_hz = 1000.0;
  std::uint64_t seed = 1;
  std::string gaze = "none";
  double blinks_per_minute = 0.0;
};
int trace_generate_command(const TraceGenerateCommand& command);

struct BenchCommand {
  std::string name;
  std::string gpu;
  bool json = false;
  bool quick = false;
  // Of `skip` alone:
  std::vector<std::string> scenes, parts, volumes;  // empty: all; all; none
  std::vector<int> partitions;                      // empty: 16 … 256
  int viewport_px = 128;
  std::string out;  // folder for table and plots; "": none
};
int bench_command(const BenchCommand& command);

struct NewStageCommand {
  std::string kind, name;
  bool glsl = false, native = false;  // neither: the form that the kind has
  std::string out;                    // "" for ./NAME
};
int new_stage_command(const NewStageCommand& command);

struct CheckStageCommand {
  std::string file;  // a stage.toml, a shared library, a folder with them, or FAMILY/NAME
  std::string gpu;
  std::vector<std::string> plugin_path;
  bool json = false;
};
int check_stage_command(const CheckStageCommand& command);

struct VerifyCommand {
  std::vector<std::string> groups;  // none: all
  std::string out;                  // folder for report.html; "" for none
  std::string gpu;
  bool json = false;
};
int verify_command(const VerifyCommand& command);

/// share/brace: $BRACE_DATA_DIR, else beside the program's bin/. Throws device_error when it is not there.
std::filesystem::path data_folder();

struct Stages {
  StageRegistry registry;
  std::vector<PluginFile> plugins;  // what the search path holds, broken files among them
};

/// Every stage that sessions can name: first the GLSL stages of the data folder and the compiled-in ones,
/// then plug-ins from `plugin_path`, BRACE_PLUGIN_PATH and the install prefix. A broken plug-in is left out;
/// only a session that names a stage which may be in it fails. Throws input_error for a place of
/// `plugin_path` that is not there.
Stages make_stages(const std::vector<std::string>& plugin_path);

/// One line on standard error per plug-in that was left out.
void warn_of_broken(const std::vector<PluginFile>& plugins);

}  // namespace brace
