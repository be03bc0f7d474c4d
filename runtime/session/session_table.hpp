#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/toml_file.hpp"
#include "runtime/session/session.hpp"

namespace brace {

/// A session file as a checked table: every key is known and of its type, defaults are filled in, overrides
/// applied. The typed Session is read from it and the resolved session is written from it.
class SessionTable {
 public:
  SessionTable(toml::table table, std::string file);

  /// Applies --set KEY=VALUE; VALUE is TOML, or plain text where that does not parse.
  void set(const std::string& key, const std::string& value);

  /// Rejects unknown keys and wrong types, then fills defaults. Call once, after set().
  void check_and_complete();

  std::string text(const std::string& key) const;
  double number(const std::string& key) const;
  std::int64_t integer(const std::string& key) const;
  bool flag(const std::string& key) const;
  std::optional<double> optional_number(const std::string& key) const;
  std::optional<std::string> optional_text(const std::string& key) const;
  const toml::node* node(const std::string& key) const;

  /// A text that must be one of the key's choices.
  std::string choice(const std::string& key) const;
  /// A number within [minimum, maximum]; the message quotes the key's accepted range.
  double number_in(const std::string& key, double minimum, double maximum) const;

  /// "session.toml:12" of a key, or "--set KEY" where it was overridden, or the file.
  std::string place(const std::string& key) const;
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  /// Replaces a key's value, or that of a parameter under [stage."FAMILY/NAME"]. `value` is TOML.
  void put(const std::string& key, const std::string& value);
  void put_of_stage(const std::string& stage, const std::string& parameter, const std::string& value);

  toml::table& table() { return table_; }
  const std::string& file() const { return file_; }

 private:
  toml::table table_;
  std::string file_;
  std::vector<std::string> overridden_;
};

}  // namespace brace
