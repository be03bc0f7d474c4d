#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/session/session.hpp"

namespace brace {

// The commands of `brace`. Each returns the exit code or throws brace::Error; main() prints it.

struct RunCommand {
  std::filesystem::path session;
  std::vector<std::string> set;  // KEY=VALUE
  std::string out;               // "" for runs/SESSION
  std::optional<std::int64_t> frames;
  std::optional<std::uint64_t> seed;
  std::string gpu;
  bool json = false;
};
int run_command(const RunCommand& command);

struct ListCommand {
  std::string what;  // devices, stages, plugins, generators, costs, transfer-functions, keys
  bool json = false;
};
int list_command(const ListCommand& command);

struct DoctorCommand {
  std::string gpu;
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
};
int trace_generate_command(const TraceGenerateCommand& command);

struct BenchCommand {
  std::string name;
  std::string gpu;
  bool json = false;
  bool quick = false;
};
int bench_command(const BenchCommand& command);

/// share/brace: $BRACE_DATA_DIR, else beside the program's bin/. Throws device_error when it is not there.
std::filesystem::path data_folder();

/// Every stage that sessions can name: the GLSL stages of the data folder and the compiled-in ones.
StageRegistry make_stage_registry();

}  // namespace brace
