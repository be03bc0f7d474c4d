#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace brace::test {

struct Outcome {
  int exit_code = -1;  // -1: ended by `signal`
  int signal = 0;
  std::string out, err;
};

/// How a command is run; every field has a sensible default.
struct RunOptions {
  std::map<std::string, std::string> environment;  // added to this program's own
  int interrupt_with = 0;                          // this signal is sent once the run has begun to write
  bool on_virtual_display = false;                 // by xvfb-run
};

/// A folder of its own for one test, removed at the end. Commands run in it.
class Workplace {
 public:
  Workplace();
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return folder_ / name; }

  void write(const std::filesystem::path& name, const std::string& text) const;
  std::string read(const std::filesystem::path& name) const;

  /// What lies in the folder, sorted, hidden files too.
  std::vector<std::string> names() const;

  /// `brace ARGUMENTS…`.
  Outcome brace(const std::vector<std::string>& arguments, const RunOptions& options = {}) const;

  /// Any program by its path.
  Outcome command(std::vector<std::string> words, const RunOptions& options = {}) const;

 private:
  std::filesystem::path folder_;
};

/// `brace run` of a session's text, with --set and further arguments; the run directory is `name`.
Outcome run_session(const Workplace& place, const std::string& session, const std::string& name,
                    const std::vector<std::string>& settings, const std::vector<std::string>& more = {});

/// One column of a CSV text with a heading, which has no commas within cells.
std::vector<std::string> csv_cells(const std::string& text, const std::string& column);
/// Its numbers; empty cells are 0.
std::vector<double> csv_column(const std::string& text, const std::string& column);

/// A quick session: a box of 32 cubed, a turning head, ten vsyncs, no pictures, no image error.
std::string quick_session();

}  // namespace brace::test
