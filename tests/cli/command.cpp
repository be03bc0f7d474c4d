#include "tests/cli/command.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace brace::test {

namespace fs = std::filesystem;

namespace {

std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path.string() + ": is not there");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<std::string> environment_with(const std::map<std::string, std::string>& added) {
  std::map<std::string, std::string> all = {{"XDG_CACHE_HOME", BRACE_TEST_CACHE_DIR}};
  all.insert(added.begin(), added.end());
  for (const auto& [name, value] : added)
    all[name] = value;
  std::vector<std::string> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (!all.contains(text.substr(0, text.find('=')))) environment.push_back(text);
  }
  for (const auto& [name, value] : all)
    environment.push_back(name + "=" + value);
  return environment;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  for (std::string& word : words)
    all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

/// Whether a run has begun: its hidden staging folder is there.
bool has_staging(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && entry.path().filename().string().front() == '.') return true;
  }
  return false;
}

int wait_for(pid_t child) {
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  return status;
}

int interrupt_and_wait(pid_t child, int signal, const fs::path& folder) {
  int status = 0;
  while (!has_staging(folder)) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::kill(child, signal);
  return wait_for(child);
}

}  // namespace

Workplace::Workplace() {
  std::string name = (fs::temp_directory_path() / "brace-cli.XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
  folder_ = name;
}

Workplace::~Workplace() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Workplace::write(const fs::path& name, const std::string& text) const {
  fs::create_directories((folder_ / name).parent_path());
  std::ofstream stream(folder_ / name, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error((folder_ / name).string() + ": cannot be written");
}

std::string Workplace::read(const fs::path& name) const {
  return read_file(folder_ / name);
}

std::vector<std::string> Workplace::names() const {
  std::vector<std::string> all;
  for (const auto& entry : fs::directory_iterator(folder_))
    all.push_back(entry.path().filename().string());
  std::sort(all.begin(), all.end());
  return all;
}

Outcome Workplace::brace(const std::vector<std::string>& arguments, const RunOptions& options) const {
  std::vector<std::string> words = {BRACE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return command(words, options);
}

Outcome Workplace::command(std::vector<std::string> words, const RunOptions& options) const {
  // Without -noreset the server starts over, and is gone for that long, whenever its last client leaves:
  // a client that asks who is there is one.
  if (options.on_virtual_display)
    words.insert(words.begin(), {"/usr/bin/xvfb-run", "-a", "-s", "-screen 0 1200x800x24 -noreset"});
  // What it says goes beside the folder, so that the folder holds nothing but what the command left there.
  const std::string out_name = folder_.string() + ".out";
  const std::string err_name = folder_.string() + ".err";
  std::vector<std::string> environment = environment_with(options.environment);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, out_name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addopen(&actions, 2, err_name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addchdir_np(&actions, folder_.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t by_default;  // a test runner in the background may have left them ignored
  sigemptyset(&by_default);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    sigaddset(&by_default, signal);
  posix_spawnattr_setsigdefault(&attributes, &by_default);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, words.front().c_str(), &actions, &attributes,
                                  pointers(words).data(), pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw std::runtime_error(words.front() + ": cannot be started");
  const int status = options.interrupt_with == 0 ? wait_for(child)
                                                 : interrupt_and_wait(child, options.interrupt_with, folder_);
  Outcome outcome;
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  outcome.out = read_file(out_name);
  outcome.err = read_file(err_name);
  fs::remove(out_name);
  fs::remove(err_name);
  return outcome;
}

Outcome run_session(const Workplace& place, const std::string& session, const std::string& name,
                    const std::vector<std::string>& settings, const std::vector<std::string>& more) {
  place.write("s.toml", session);
  std::vector<std::string> arguments = {"run", "s.toml", "--out", name};
  for (const std::string& setting : settings)
    arguments.insert(arguments.end(), {"--set", setting});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return place.brace(arguments);
}

std::vector<std::string> csv_cells(const std::string& text, const std::string& column) {
  std::istringstream rows(text);
  std::string row, cell;
  std::getline(rows, row);
  std::istringstream headings(row);
  int at = 0;
  while (std::getline(headings, cell, ',') && cell != column)
    ++at;
  if (cell != column) throw std::runtime_error("no column " + column);
  std::vector<std::string> found;
  while (std::getline(rows, row)) {
    std::istringstream cells(row);
    for (int i = 0; i <= at; ++i) {
      cell.clear();
      std::getline(cells, cell, ',');
    }
    found.push_back(cell);
  }
  return found;
}

std::vector<double> csv_column(const std::string& text, const std::string& column) {
  std::vector<double> numbers;
  for (const std::string& cell : csv_cells(text, column))
    numbers.push_back(cell.empty() ? 0.0 : std::stod(cell));
  return numbers;
}

std::string quick_session() {
  return R"([device]
profile = "htc-vive"
resolution_scale = 0.05
[trace]
neck = { motion = "rotation", degrees = 30, seconds = 0.3 }
[scene]
volume = "generator:solid_box:32"
size_m = 0.4
position = "front:0.8"
[clock]
cost = "model:gtx-1080"
[output]
images = "none"
error = "none"
[run]
frames = 10
)";
}

}  // namespace brace::test
