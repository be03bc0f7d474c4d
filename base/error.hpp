#pragma once

#include <stdexcept>
#include <string>

#include <fmt/core.h>

namespace brace {

/// Exit codes of the command. They are a contract with scripts.
enum class ExitCode : int { done = 0, check_failed = 1, bad_input = 2, device_or_plugin_failed = 3 };

/// Everything Brace reports to a user. The message names the file, key or line, says what is wrong and what
/// is accepted; `exit_code` is what the command ends with.
class Error : public std::runtime_error {
 public:
  Error(ExitCode exit_code, const std::string& message)
      : std::runtime_error(message), exit_code_(exit_code) {}
  ExitCode exit_code() const { return exit_code_; }

 private:
  ExitCode exit_code_;
};

/// Bad input or usage: exit code 2.
template <typename... Args>
[[nodiscard]] Error input_error(fmt::format_string<Args...> format, Args&&... args) {
  return Error(ExitCode::bad_input, fmt::format(format, std::forward<Args>(args)...));
}

/// The device or a plug-in failed: exit code 3.
template <typename... Args>
[[nodiscard]] Error device_error(fmt::format_string<Args...> format, Args&&... args) {
  return Error(ExitCode::device_or_plugin_failed, fmt::format(format, std::forward<Args>(args)...));
}

[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace brace

/// A programming error if false. Stays on in release builds.
#define BRACE_CHECK(condition) \
  (static_cast<bool>(condition) ? void(0) : ::brace::check_failed(#condition, __FILE__, __LINE__))
