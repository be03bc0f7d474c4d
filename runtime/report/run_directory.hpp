#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace brace {

struct ReportInput;

/// A run directory appears whole or not at all. Everything is written into a hidden sibling of the directory
/// asked for; commit() flushes it to the disk and renames it. Without a commit() the destructor removes it,
/// and the parent folders made for it.
///
/// An existing path is taken only if it is an empty folder, or a run directory of Brace (its summary.json
/// says so) that holds nothing Brace would not write: that one is replaced in a single step at commit().
/// Anything else is refused with brace::Error, exit code 2, before any work is done. So are paths that cannot
/// be written. A full disk is exit code 3.
class RunDirectory {
 public:
  explicit RunDirectory(std::filesystem::path destination);
  ~RunDirectory();
  RunDirectory(const RunDirectory&) = delete;
  RunDirectory& operator=(const RunDirectory&) = delete;

  const std::filesystem::path& destination() const { return destination_; }

  /// Where to write a file for now; folders in `name` ("images/000042_left.png") are made.
  std::filesystem::path path(const std::filesystem::path& name) const;

  void write_text(const std::filesystem::path& name, std::string_view text) const;

  void commit();

 private:
  std::filesystem::path destination_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_parents_;  // outermost first
  bool committed_ = false;
};

/// A series' label as a part of a file name: "warp/quad" gives "warp_quad".
std::string file_part(std::string label);

/// Writes summary.json, frames.csv, timeline.json, report.html and session.toml into `run`; with several
/// series the first one's records go to frames.csv and the others' to frames-LABEL.csv. Pictures must be
/// there already. `page_folder` holds the page's template (share/brace/report). Does not commit.
void write_run(RunDirectory& run, const ReportInput& input, const std::filesystem::path& page_folder);

}  // namespace brace
