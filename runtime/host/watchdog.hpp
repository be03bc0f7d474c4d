#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/memory.hpp"
#include "runtime/gpu/pipeline.hpp"

namespace brace {

/// How closely a run watches its stages.
enum class WatchdogLevel {
  off,      // nothing is checked, nothing is in the way
  outputs,  // results of every ray
  full      // and guard zones behind the buffers that stages write, and that they leave their inputs alone
};

/// "off", "outputs" or "full"; throws input_error otherwise.
WatchdogLevel parse_watchdog_level(const std::string& text);
const char* to_string(WatchdogLevel level);

enum class WatchdogClause {
  not_finite,    // NaN or Inf in a colour, NaN or -Inf in a depth
  colour_range,  // r, g or b outside [0, opacity]
  opacity_range,
  depth_range,      // a depth below zero
  written_outside,  // words of guard zones that were overwritten
  input_changed,    // input buffers that were overwritten
  deadline,         // jobs that took longer than their deadline
  device_lost
};
const char* to_string(WatchdogClause clause);

/// One kind of fault of one stage in a run.
struct WatchdogReport {
  std::string stage;  // "cast/mip"
  std::string clause;
  std::uint64_t count = 0;       // of rays, words, jobs
  std::int64_t first_frame = 0;  // the first frame it was seen in
};

/// Bytes that are put behind a watched buffer.
inline constexpr std::uint64_t watchdog_guard_bytes = 4096;

/// Watches what stages do. Costs nothing at the level off: then no call below does anything.
class Watchdog {
 public:
  Watchdog() = default;
  /// `kernels_folder` holds watchdog.comp. The device must outlive it.
  Watchdog(const gpu::Device& device, WatchdogLevel level, const std::filesystem::path& kernels_folder);

  WatchdogLevel level() const { return level_; }
  bool watches_outputs() const { return level_ != WatchdogLevel::off; }
  bool watches_memory() const { return level_ == WatchdogLevel::full; }

  /// Records the check of the first `rays` results; what wrote them is before it behind a barrier.
  void record_output_check(gpu::CommandList& commands, const gpu::Buffer& colours,
                           const gpu::Buffer& depths_m, std::uint32_t rays);
  /// Takes the counts of the checks since the last call, after their commands are done.
  void collect_outputs(const std::string& stage, std::int64_t frame);

  /// Fills the guard zone: the last watchdog_guard_bytes of a buffer that is this much larger than what a
  /// stage is told. Once, before the first frame.
  void arm_guard(const gpu::Buffer& buffer);
  /// Counts overwritten words of the zone and arms it again. The device is idle.
  void check_guard(const std::string& stage, std::int64_t frame, const gpu::Buffer& buffer);

  /// Remembers the contents of an input; check_input compares. One input after the other, at most
  /// `inputs_max`.
  static constexpr std::size_t inputs_max = 4;
  void remember_input(const gpu::Buffer& buffer);
  void check_inputs(const std::string& stage, std::int64_t frame);

  /// `deadline_ns` <= 0: none.
  void job_done(const std::string& stage, std::int64_t frame, std::int64_t duration_ns,
                std::int64_t deadline_ns);

  /// Runs `call`; a lost device in it is counted for `stage` and thrown on with the stage's name.
  void attribute_loss(const std::string& stage, std::int64_t frame, const std::function<void()>& call);

  void add(const std::string& stage, WatchdogClause clause, std::uint64_t count, std::int64_t frame);
  /// Everything found so far, in order of first occurrence.
  const std::vector<WatchdogReport>& reports() const { return reports_; }

 private:
  struct Input {
    const gpu::Buffer* buffer = nullptr;
    std::vector<std::byte> before;
  };

  const gpu::Device* device_ = nullptr;
  WatchdogLevel level_ = WatchdogLevel::off;
  gpu::ComputePipeline check_;
  gpu::Buffer counts_;
  std::vector<Input> inputs_;
  std::size_t inputs_used_ = 0;
  std::vector<std::byte> scratch_;
  std::vector<WatchdogReport> reports_;
};

}  // namespace brace
