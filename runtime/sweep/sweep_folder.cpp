#include "runtime/sweep/sweep_folder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/error.hpp"
#include "runtime/report/output_file.hpp"

namespace brace {

namespace fs = std::filesystem;

namespace {

void refuse_foreign(const fs::path& folder) {
  constexpr std::array<std::string_view, 8> ours = {
      "results.sqlite", "results.sqlite-journal", "results.csv", "results.csv.partial",
      "report.html",    "report.html.partial",    "runs",        "work"};
  bool has_results = fs::is_empty(folder);
  std::string foreign;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    has_results = has_results || name == ours.front();
    if (std::find(ours.begin(), ours.end(), name) == ours.end()) foreign = name;
  }
  if (has_results && foreign.empty()) return;
  throw input_error(
      "{}: is there already and {}; accepted: a new folder, or one with a sweep to go on with",
      folder.string(),
      foreign.empty() ? "holds no results.sqlite" : "holds '" + foreign + "', which no sweep wrote");
}

}  // namespace

SweepFolder::SweepFolder(fs::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) throw input_error("the sweep's folder has an empty name; give one with --out");
  std::error_code error;
  if (fs::exists(folder_, error) && !fs::is_directory(folder_, error))
    throw input_error("{}: is there already and is no folder; name another one with --out", folder_.string());
  fs::create_directories(folder_, error);
  if (error) throw_file_error(folder_, "cannot make the folder", error.value());
  refuse_foreign(folder_);
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) throw_file_error(folder_, "cannot be opened", errno);
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw input_error("{}: another sweep is running in it; wait for it or name another folder with --out",
                      folder_.string());
  }
  fs::remove_all(work(), error);
  fs::create_directory(work(), error);
  if (!error) return;
  ::close(lock_);
  throw_file_error(work(), "cannot make the folder", error.value());
}

SweepFolder::~SweepFolder() {
  std::error_code ignored;
  fs::remove_all(work(), ignored);
  ::close(lock_);
}

}  // namespace brace
