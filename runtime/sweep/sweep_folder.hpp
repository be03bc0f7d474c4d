#pragma once

#include <filesystem>

namespace brace {

/// The folder that a sweep writes to, made if need be and locked against a second sweep. Everything half-done
/// lies in work(), which is emptied at the start and removed at the end.
class SweepFolder {
 public:
  /// Throws input_error if the path is no folder, holds anything but a sweep, or is in use.
  explicit SweepFolder(std::filesystem::path folder);
  ~SweepFolder();
  SweepFolder(const SweepFolder&) = delete;
  SweepFolder& operator=(const SweepFolder&) = delete;

  std::filesystem::path results() const { return folder_ / "results.sqlite"; }
  std::filesystem::path csv() const { return folder_ / "results.csv"; }
  std::filesystem::path page() const { return folder_ / "report.html"; }
  std::filesystem::path runs() const { return folder_ / "runs"; }
  std::filesystem::path work() const { return folder_ / "work"; }

 private:
  std::filesystem::path folder_;
  int lock_ = -1;
};

}  // namespace brace
