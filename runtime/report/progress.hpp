#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace brace {

/// Tells a user how far something is. On a terminal: one line with a bar and the time left, redrawn at most
/// ten times a second. Elsewhere (a log): a plain line at each further tenth. Nothing at all for what
/// ends within a second. Cheap enough for every vsync of a pacing replay.
class ProgressMeter {
 public:
  /// `what` stands before the bar ("casting"); total in `unit`s, 0 if not known. Without a
  /// unit only the share is told, not the count. `stream` is not owned.
  ProgressMeter(std::string what, std::uint64_t total, std::string unit = "", std::FILE* stream = stderr);
  ~ProgressMeter();  // ends the terminal's line
  ProgressMeter(const ProgressMeter&) = delete;
  ProgressMeter& operator=(const ProgressMeter&) = delete;

  void update(std::uint64_t done) {
    done_ = done;
    if (done >= look_at_) look(done);
  }
  /// The last line: "casting: 900 vsyncs in 12 s".
  void finish();

 private:
  void look(std::uint64_t done);
  double elapsed_s() const;

  std::string what_;
  std::string unit_;
  std::uint64_t total_;
  std::FILE* stream_;
  bool terminal_;
  std::uint64_t look_at_ = 0;
  std::uint64_t done_ = 0;
  int tenths_told_ = 0;
  double drawn_at_s_ = 0;
  bool line_open_ = false;
  bool finished_ = false;
  std::chrono::steady_clock::time_point start_;
};

/// "casting  [=========>          ]  45 %  405/900 vsyncs  0:12 left", at most `columns` wide.
std::string progress_bar_line(const std::string& what, const std::string& unit, std::uint64_t done,
                              std::uint64_t total, double elapsed_s, int columns);

/// "casting: 40 % (360/900 vsyncs), 0:12 left".
std::string progress_log_line(const std::string& what, const std::string& unit, std::uint64_t done,
                              std::uint64_t total, double elapsed_s);

/// "0:09", "12:34", "1:02:03".
std::string duration_text(double seconds);

}  // namespace brace
