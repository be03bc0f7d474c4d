#include "tests/fuzz/targets.hpp"

#include <filesystem>
#include <fstream>
#include <optional>

#include <unistd.h>

#include "base/error.hpp"
#include "hmd_sim/trace_io.hpp"
#include "runtime/host/stage_registry.hpp"
#include "runtime/session/session.hpp"
#include "runtime/volume/transfer_function.hpp"
#include "runtime/volume/volume.hpp"

namespace brace::fuzz {

namespace {

std::string text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The bytes as a file, for readers that want one; in memory where the system has such a folder.
class InputFile {
 public:
  InputFile(std::span<const std::uint8_t> bytes, const std::string& suffix) {
    std::error_code ignored;
    const std::filesystem::path memory = "/dev/shm";
    const bool has_memory = std::filesystem::is_directory(memory, ignored);
    path_ = (has_memory ? memory : std::filesystem::temp_directory_path()) /
            ("brace-fuzz-" + std::to_string(getpid()) + suffix);
    std::ofstream(path_, std::ios::binary) << text_of(bytes);
  }
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void read_manifest(std::span<const std::uint8_t> bytes) {
  const InputFile file(bytes, ".toml");
  (void)read_stage_manifest(file.path());
}

StageRegistry session_stages() {
  StageRegistry stages;
  for (const std::string& family : stage_families()) {
    StageInfo stage;
    stage.family = family;
    // The names that sessions have by default, so that a session can get through.
    stage.name = family == "rays"       ? "full_rate"
                 : family == "cast"     ? "dvr"
                 : family == "stereo"   ? "two_pass"
                 : family == "schedule" ? "whole_frame"
                 : family == "warp"     ? "quad"
                 : family == "control"  ? "fixed"
                 : family == "predict"  ? "constant_rate"
                                        : "none";
    StageParameter number;
    number.name = "step_voxels";
    number.maximum = 64.0;
    number.default_value = 0.5;
    StageParameter choice;
    choice.name = "mode";
    choice.type = ParameterType::choice;
    choice.choices = {"one", "two"};
    choice.maximum = 1.0;
    stage.parameters = {number, choice};
    stages.add(stage);
  }
  return stages;
}

void read_session(std::span<const std::uint8_t> bytes) {
  static const StageRegistry stages = session_stages();
  (void)parse_session(text_of(bytes), "session.toml", "/", {}, stages);
}

void read_trace(std::span<const std::uint8_t> bytes) {
  const sim::TraceReadResult read = sim::parse_trace(text_of(bytes), "trace");
  (void)sim::describe(read.repairs);
}

/// The first byte chooses the file's ending; what a header promises is read if it is small.
void read_volume(std::span<const std::uint8_t> bytes) {
  static const std::vector<std::string> endings = {".nrrd", ".nhdr", ".nii", ".nii.gz",
                                                   ".mha",  ".mhd",  ".raw"};
  if (bytes.empty()) return;
  const std::string& ending = endings[bytes[0] % endings.size()];
  std::optional<InputFile> raw_header;
  if (ending == ".raw") raw_header.emplace(bytes.subspan(1), ".raw.toml");
  const InputFile file(bytes.subspan(1), ending);
  const std::unique_ptr<VolumeSource> source = open_volume(file.path().string());
  if (source->info().byte_count() <= (std::size_t{1} << 22)) (void)load_volume(*source);
}

void read_transfer_function(std::span<const std::uint8_t> bytes) {
  const TransferFunction tf = parse_transfer_function(text_of(bytes), "transfer_function.toml");
  (void)bake(resolve(tf, {0.0, 255.0}, 0.001), {{0.0, 255.0}, 256});
}

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all = {{"manifest", read_manifest},
                                          {"session", read_session},
                                          {"trace", read_trace},
                                          {"volume", read_volume},
                                          {"transfer_function", read_transfer_function}};
  return all;
}

void run(const Target& target, std::span<const std::uint8_t> bytes) {
  try {
    target.read(bytes);
  } catch (const Error&) {  // refused: that is fine
  }
}

}  // namespace brace::fuzz
