#include "runtime/report/progress.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace brace {

namespace {

constexpr double silent_s = 1.0;
constexpr double redraw_s = 0.1;

int terminal_columns(std::FILE* stream) {
  winsize size{};
  if (::ioctl(fileno(stream), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

std::string counts_text(const std::string& unit, std::uint64_t done, std::uint64_t total) {
  const std::string of = total == 0 ? std::string() : fmt::format("/{}", total);
  return fmt::format("{}{} {}", done, of, unit);
}

int percent(std::uint64_t done, std::uint64_t total) {
  return static_cast<int>(100.0 * static_cast<double>(std::min(done, total)) / static_cast<double>(total));
}

std::string left_text(std::uint64_t done, std::uint64_t total, double elapsed_s) {
  if (done == 0 || done >= total) return {};
  const double share = static_cast<double>(done) / static_cast<double>(total);
  return duration_text(elapsed_s * (1.0 - share) / share) + " left";
}

}  // namespace

std::string duration_text(double seconds) {
  const auto s = static_cast<long long>(std::clamp(std::round(seconds), 0.0, 1e9));
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string progress_bar_line(const std::string& what, const std::string& unit, std::uint64_t done,
                              std::uint64_t total, double elapsed_s, int columns) {
  std::string line;
  if (total == 0) {
    const std::string counts = unit.empty() ? "" : "  " + counts_text(unit, done, 0);
    line = fmt::format("{}{}  {}", what, counts, duration_text(elapsed_s));
  } else {
    const std::string left = left_text(done, total, elapsed_s);
    const std::string counts = unit.empty() ? "" : "  " + counts_text(unit, done, total);
    const std::string tail =
        fmt::format("  {:3} %{}{}{}", percent(done, total), counts, left.empty() ? "" : "  ", left);
    line = what + tail;
    const int room = std::min(30, columns - static_cast<int>(line.size()) - 4);
    if (room >= 5) {
      const auto filled = static_cast<std::size_t>(room * percent(done, total) / 100);
      const auto empty = static_cast<std::size_t>(room) - filled;
      line = fmt::format("{}  [{}{}]{}", what, std::string(filled, '='), std::string(empty, ' '), tail);
    }
  }
  return line.substr(0, static_cast<std::size_t>(std::max(columns, 1)));
}

std::string progress_log_line(const std::string& what, const std::string& unit, std::uint64_t done,
                              std::uint64_t total, double elapsed_s) {
  const std::string left = left_text(done, total, elapsed_s);
  const std::string counts = unit.empty() ? "" : fmt::format(" ({})", counts_text(unit, done, total));
  return fmt::format("{}: {} %{}{}{}", what, percent(done, total), counts, left.empty() ? "" : ", ", left);
}

ProgressMeter::ProgressMeter(std::string what, std::uint64_t total, std::string unit, std::FILE* stream)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      stream_(stream),
      terminal_(::isatty(fileno(stream)) == 1),
      start_(std::chrono::steady_clock::now()) {}

ProgressMeter::~ProgressMeter() {
  if (!line_open_) return;
  fmt::print(stream_, "\n");
  std::fflush(stream_);
}

double ProgressMeter::elapsed_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void ProgressMeter::look(std::uint64_t done) {
  // The clock is read a thousand times over the whole at most, whatever the pace of the steps.
  look_at_ = done + std::max<std::uint64_t>(1, total_ / 1000);
  const double now_s = elapsed_s();
  if (now_s < silent_s) return;
  if (terminal_) {
    if (line_open_ && now_s - drawn_at_s_ < redraw_s) return;
    drawn_at_s_ = now_s;
    line_open_ = true;
    fmt::print(stream_, "\r\x1b[K{}",
               progress_bar_line(what_, unit_, done, total_, now_s, terminal_columns(stream_) - 1));
    std::fflush(stream_);
  } else if (total_ > 0) {
    const int tenths = percent(done, total_) / 10;
    if (tenths <= tenths_told_ || tenths >= 10) return;
    tenths_told_ = tenths;
    fmt::print(stream_, "{}\n", progress_log_line(what_, unit_, done, total_, now_s));
    std::fflush(stream_);
  }
}

void ProgressMeter::finish() {
  if (finished_) return;
  finished_ = true;
  const double now_s = elapsed_s();
  if (line_open_) fmt::print(stream_, "\r\x1b[K");
  line_open_ = false;
  if (now_s < silent_s) return;
  const std::string counts = unit_.empty() ? "done" : counts_text(unit_, done_, 0);
  fmt::print(stream_, "{}: {} in {}\n", what_, counts, duration_text(now_s));
  std::fflush(stream_);
}

}  // namespace brace
