#include "runtime/sweep/child_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"

namespace brace {

namespace {

std::vector<std::string> environment_with(const std::map<std::string, std::string>& added) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (!added.contains(text.substr(0, text.find('=')))) all.push_back(text);
  }
  for (const auto& [name, value] : added)
    all.push_back(name + "=" + value);
  return all;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  for (std::string& word : words)
    all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

/// After fork(): only what signal handlers may do too.
[[noreturn]] void become(char** words, char** environment, int null, int errors, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(child_not_started);  // it ended before the line above
  ::dup2(null, 0);
  ::dup2(null, 1);
  ::dup2(errors, 2);
  ::execve(words[0], words, environment);
  ::_exit(child_not_started);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words,
                           const std::map<std::string, std::string>& environment,
                           const std::filesystem::path& error_file) {
  std::vector<std::string> all = words, variables = environment_with(environment);
  const std::vector<char*> word_pointers = pointers(all), variable_pointers = pointers(variables);
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const int errors = ::open(error_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const pid_t parent = ::getpid();
  int failed = null < 0 || errors < 0 ? errno : 0;
  if (failed == 0) {
    process_ = ::fork();
    if (process_ == 0)
      become(const_cast<char**>(word_pointers.data()), const_cast<char**>(variable_pointers.data()), null,
             errors, parent);
    failed = process_ < 0 ? errno : 0;
  }
  if (null >= 0) ::close(null);
  if (errors >= 0) ::close(errors);
  if (failed == 0) {
    // By its number: glibc 2.36 declares pidfd_open() for C alone.
    descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, process_, 0));
    if (descriptor_ >= 0) return;
    failed = errno;
    kill_and_wait();
  }
  throw device_error("{}: cannot be started: {}", words.front(), std::strerror(failed));
}

ChildProcess::~ChildProcess() {
  kill_and_wait();
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)), descriptor_(std::exchange(other.descriptor_, -1)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

void ChildProcess::kill_and_wait() noexcept {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (descriptor_ >= 0) ::close(descriptor_);
  process_ = descriptor_ = -1;
}

std::optional<ChildEnd> ChildProcess::ended() {
  BRACE_CHECK(process_ > 0);
  int status = 0;
  if (::waitpid(process_, &status, WNOHANG) != process_) return std::nullopt;
  process_ = -1;
  if (WIFSIGNALED(status)) return ChildEnd{0, WTERMSIG(status)};
  return ChildEnd{WEXITSTATUS(status), 0};
}

void wait_for_any(const std::vector<const ChildProcess*>& children) {
  std::vector<pollfd> polled;
  for (const ChildProcess* child : children)
    polled.push_back({child->descriptor(), POLLIN, 0});
  ::poll(polled.data(), polled.size(), 200);
}

}  // namespace brace
