#include "runtime/report/run_directory.hpp"

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <stdio.h>
#include <unistd.h>

#include "base/error.hpp"
#include "runtime/report/output_file.hpp"
#include "runtime/report/summary.hpp"

namespace brace {

namespace fs = std::filesystem;

namespace {

bool is_marked_as_run(const fs::path& folder) {
  std::ifstream stream(folder / "summary.json");
  if (!stream) return false;
  const nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  return summary.is_object() && summary.value("format", std::string()) == summary_format;
}

// Names Brace writes at the top of a run directory: "frames.csv", and "frames-LABEL.csv" and "images-LABEL"
// of a run with several series.
bool is_brace_file(const std::string& name) {
  static const std::set<std::string> fixed = {"summary.json", "timeline.json", "report.html", "session.toml",
                                              "images"};
  if (fixed.contains(name) || name.starts_with("images-")) return true;
  const auto is_csv = [&](const char* stem) { return name.starts_with(stem) && name.ends_with(".csv"); };
  return is_csv("frames") || is_csv("costs");
}

void refuse_foreign_folder(const fs::path& destination) {
  if (!fs::is_directory(destination)) {
    throw input_error("{}: is there already and is no folder; name another one with --out",
                      destination.string());
  }
  if (fs::is_empty(destination)) return;
  if (!is_marked_as_run(destination)) {
    throw input_error(
        "{}: is there already and is no run directory (its summary.json does not say so); accepted are a new "
        "name, an empty folder or an earlier run: name another one with --out",
        destination.string());
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(destination)) {
    const std::string name = entry.path().filename().string();
    if (is_brace_file(name)) continue;
    throw input_error(
        "{}: is an earlier run, but holds '{}', which Brace did not write and would have to delete; move it "
        "away or name another folder with --out",
        destination.string(), name);
  }
}

// The parent folders that are missing, outermost first, made one by one so that they can be taken back.
std::vector<fs::path> make_parents(const fs::path& parent) {
  std::vector<fs::path> missing;
  for (fs::path p = parent; !p.empty() && !fs::exists(p); p = p.parent_path())
    missing.insert(missing.begin(), p);
  std::vector<fs::path> made;
  for (const fs::path& p : missing) {
    std::error_code error;
    if (fs::create_directory(p, error)) made.push_back(p);
    if (!error) continue;
    for (auto last = made.rbegin(); last != made.rend(); ++last)
      ::rmdir(last->c_str());
    throw_file_error(p, "cannot make the folder", error.value());
  }
  return made;
}

fs::path make_staging(const fs::path& destination) {
  std::string name =
      (destination.parent_path() / fmt::format(".{}.XXXXXX", destination.filename().string())).string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw_file_error(destination.parent_path(), "cannot make a folder in it", errno);
  }
  fs::permissions(name, fs::perms(0755));  // mkdtemp's 0700 would hide the run from the user's group
  return name;
}

void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);  // not every file system can; the rename is atomic all the same
  ::close(descriptor);
}

void move_into_place(const fs::path& staging, const fs::path& destination) {
  // Over nothing and over an empty folder, rename(2) is one step.
  if (::rename(staging.c_str(), destination.c_str()) == 0) return;
  if (errno != ENOTEMPTY && errno != EEXIST) throw_file_error(destination, "cannot be put in place", errno);
  refuse_foreign_folder(destination);  // it may have changed since the run began
  if (::renameat2(AT_FDCWD, staging.c_str(), AT_FDCWD, destination.c_str(), RENAME_EXCHANGE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) throw_file_error(destination, "cannot be put in place", errno);
  // The file system cannot exchange two folders: aside, then in. A crash between the two leaves both whole.
  const fs::path aside = staging.string() + ".old";
  if (::rename(destination.c_str(), aside.c_str()) != 0) {
    throw_file_error(destination, "cannot be replaced", errno);
  }
  if (::rename(staging.c_str(), destination.c_str()) != 0) {
    const int error_number = errno;
    ::rename(aside.c_str(), destination.c_str());
    throw_file_error(destination, "cannot be put in place", error_number);
  }
  ::rename(aside.c_str(), staging.c_str());
}

}  // namespace

std::string file_part(std::string label) {
  for (char& c : label) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-';
    if (!plain) c = '_';
  }
  return label;
}

RunDirectory::RunDirectory(fs::path destination) {
  if (destination.empty()) throw input_error("the run directory's name is empty; give one with --out");
  destination_ = fs::absolute(destination).lexically_normal();
  if (!destination_.has_filename()) destination_ = destination_.parent_path();  // "runs/a/"
  try {
    // Through a link, so that the folder is replaced and not the link to it.
    if (fs::is_symlink(destination_)) destination_ = fs::weakly_canonical(destination_);
    if (fs::exists(destination_)) refuse_foreign_folder(destination_);
    made_parents_ = make_parents(destination_.parent_path());
    staging_ = make_staging(destination_);
  } catch (const fs::filesystem_error& e) {
    throw_file_error(destination_, "cannot be used as a run directory", e.code().value());
  }
}

RunDirectory::~RunDirectory() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
  if (committed_) return;
  for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) {
    ::rmdir(parent->c_str());  // keeps what others have put there meanwhile
  }
}

fs::path RunDirectory::path(const fs::path& name) const {
  const fs::path full = staging_ / name;
  std::error_code error;
  fs::create_directories(full.parent_path(), error);
  if (error) throw_file_error(full.parent_path(), "cannot make the folder", error.value());
  return full;
}

void RunDirectory::write_text(const fs::path& name, std::string_view text) const {
  OutputFile file(path(name));
  file.write(text);
  file.close();
}

void RunDirectory::commit() {
  BRACE_CHECK(!committed_);
  sync_folder(staging_);
  move_into_place(staging_, destination_);
  sync_folder(destination_.parent_path());
  committed_ = true;
}

}  // namespace brace
