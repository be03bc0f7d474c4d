#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace brace {

inline constexpr int child_not_started = 127;  // exit code, as a shell says it

/// How a child process ended.
struct ChildEnd {
  int exit_code = 0;
  int signal = 0;  // 0: it ended by itself
};

/// A program in a process group of its own, so that Ctrl-C on the terminal reaches the parent alone. Standard
/// input and output are /dev/null, standard error goes to a file. It is killed when this process ends in any
/// way, and by the destructor.
class ChildProcess {
 public:
  /// `environment` is added to this process's own. Throws device_error if it cannot be started.
  ChildProcess(const std::vector<std::string>& words, const std::map<std::string, std::string>& environment,
               const std::filesystem::path& error_file);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  /// How it ended, if it has.
  std::optional<ChildEnd> ended();
  /// Becomes readable for poll(2) when it ends.
  int descriptor() const { return descriptor_; }

 private:
  void kill_and_wait() noexcept;

  pid_t process_ = -1;
  int descriptor_ = -1;
};

/// Returns when one of the children may have ended, after a signal to this process, or after 0.2 s.
void wait_for_any(const std::vector<const ChildProcess*>& children);

}  // namespace brace
