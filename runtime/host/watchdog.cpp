#include "runtime/host/watchdog.hpp"

#include <algorithm>
#include <span>

#include "base/error.hpp"
#include "base/suggest.hpp"

namespace brace {

namespace {

constexpr std::uint32_t kGuardWord = 0xb7ace5a5u;
constexpr std::size_t kCounts = 4;  // clauses that the kernel counts, in the order of WatchdogClause

}  // namespace

const char* to_string(WatchdogLevel level) {
  return level == WatchdogLevel::off ? "off" : level == WatchdogLevel::outputs ? "outputs" : "full";
}

WatchdogLevel parse_watchdog_level(const std::string& text) {
  std::vector<std::string> names;
  for (const WatchdogLevel level : {WatchdogLevel::off, WatchdogLevel::outputs, WatchdogLevel::full}) {
    if (text == to_string(level)) return level;
    names.emplace_back(to_string(level));
  }
  throw input_error("'{}' is not a level of the watchdog{}; accepted: {}", text, did_you_mean(text, names),
                    join(names));
}

const char* to_string(WatchdogClause clause) {
  switch (clause) {
    case WatchdogClause::not_finite:
      return "NaN or Inf in a result";
    case WatchdogClause::colour_range:
      return "colour outside [0, opacity]";
    case WatchdogClause::opacity_range:
      return "opacity outside [0, 1]";
    case WatchdogClause::depth_range:
      return "depth below zero";
    case WatchdogClause::written_outside:
      return "written outside its area";
    case WatchdogClause::input_changed:
      return "input overwritten";
    case WatchdogClause::deadline:
      return "over the deadline";
    case WatchdogClause::device_lost:
      return "device lost";
  }
  return "?";
}

Watchdog::Watchdog(const gpu::Device& device, WatchdogLevel level,
                   const std::filesystem::path& kernels_folder)
    : device_(&device), level_(level) {
  if (level == WatchdogLevel::off) return;
  gpu::KernelDescription kernel;
  kernel.main = gpu::read_glsl(kernels_folder / "watchdog.comp");
  check_ = gpu::make_pipeline(device, kernel);
  counts_ = gpu::Buffer(device, "watchdog counts", kCounts * sizeof(std::uint32_t), gpu::Memory::readback);
  const std::array<std::uint32_t, kCounts> zero{};
  gpu::upload_values(device, counts_, std::span<const std::uint32_t>(zero));
  inputs_.resize(inputs_max);
}

void Watchdog::add(const std::string& stage, WatchdogClause clause, std::uint64_t count, std::int64_t frame) {
  if (count == 0) return;
  const std::string name = to_string(clause);
  for (WatchdogReport& report : reports_) {
    if (report.stage != stage || report.clause != name) continue;
    report.count += count;
    return;
  }
  reports_.push_back({stage, name, count, frame});
}

void Watchdog::record_output_check(gpu::CommandList& commands, const gpu::Buffer& colours,
                                   const gpu::Buffer& depths_m, std::uint32_t rays) {
  if (!watches_outputs() || rays == 0) return;
  commands.dispatch(check_, {gpu::bind(0, colours), gpu::bind(1, depths_m), gpu::bind(2, counts_)},
                    gpu::push_bytes(rays), check_.groups_for(static_cast<int>(rays)));
  commands.barrier();
}

void Watchdog::collect_outputs(const std::string& stage, std::int64_t frame) {
  if (!watches_outputs()) return;
  std::array<std::uint32_t, kCounts> counts{};
  gpu::download_values(*device_, counts_, std::span<std::uint32_t>(counts));
  for (std::size_t i = 0; i < kCounts; ++i)
    add(stage, static_cast<WatchdogClause>(i), counts[i], frame);
  const std::array<std::uint32_t, kCounts> zero{};
  gpu::upload_values(*device_, counts_, std::span<const std::uint32_t>(zero));
}

void Watchdog::arm_guard(const gpu::Buffer& buffer) {
  if (!watches_memory()) return;
  BRACE_CHECK(buffer.size_bytes() >= watchdog_guard_bytes);
  const std::vector<std::uint32_t> words(watchdog_guard_bytes / 4, kGuardWord);
  gpu::upload_values(*device_, buffer, std::span<const std::uint32_t>(words),
                     buffer.size_bytes() - watchdog_guard_bytes);
}

void Watchdog::check_guard(const std::string& stage, std::int64_t frame, const gpu::Buffer& buffer) {
  if (!watches_memory()) return;
  std::vector<std::uint32_t> words(watchdog_guard_bytes / 4);
  gpu::download_values(*device_, buffer, std::span<std::uint32_t>(words),
                       buffer.size_bytes() - watchdog_guard_bytes);
  const auto spoilt =
      std::count_if(words.begin(), words.end(), [](std::uint32_t w) { return w != kGuardWord; });
  if (spoilt == 0) return;
  add(stage, WatchdogClause::written_outside, static_cast<std::uint64_t>(spoilt), frame);
  arm_guard(buffer);
}

void Watchdog::remember_input(const gpu::Buffer& buffer) {
  if (!watches_memory()) return;
  BRACE_CHECK(inputs_used_ < inputs_max);
  Input& input = inputs_[inputs_used_++];
  input.buffer = &buffer;
  input.before.resize(buffer.size_bytes());
  gpu::download(*device_, buffer, input.before);
}

void Watchdog::check_inputs(const std::string& stage, std::int64_t frame) {
  for (std::size_t i = 0; i < inputs_used_; ++i) {
    scratch_.resize(inputs_[i].before.size());
    gpu::download(*device_, *inputs_[i].buffer, scratch_);
    if (scratch_ != inputs_[i].before) add(stage, WatchdogClause::input_changed, 1, frame);
  }
  inputs_used_ = 0;
}

void Watchdog::job_done(const std::string& stage, std::int64_t frame, std::int64_t duration_ns,
                        std::int64_t deadline_ns) {
  if (!watches_outputs() || deadline_ns <= 0 || duration_ns <= deadline_ns) return;
  add(stage, WatchdogClause::deadline, 1, frame);
}

void Watchdog::attribute_loss(const std::string& stage, std::int64_t frame,
                              const std::function<void()>& call) {
  try {
    call();
  } catch (const gpu::DeviceLost& lost) {
    add(stage, WatchdogClause::device_lost, 1, frame);
    throw gpu::DeviceLost(fmt::format("{} (in stage {}, eye frame {})", lost.what(), stage, frame));
  }
}

}  // namespace brace
