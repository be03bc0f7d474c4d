#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace brace {

/// An SQLite file, opened or created. Whatever was committed is still there after a crash at any time.
/// Failures throw brace::Error naming the file: a file that is no database is exit code 2, a full disk exit
/// code 3.
class Database {
 public:
  explicit Database(std::filesystem::path file);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Statements without results.
  void execute(const std::string& sql);
  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void fail(int code) const;

 private:
  friend class Statement;
  std::filesystem::path file_;
  sqlite3* handle_ = nullptr;
};

/// One prepared statement; columns count from 0, parameters from 1. Lives no longer than its database.
class Statement {
 public:
  Statement(Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void bind(int parameter, std::int64_t value);
  void bind(int parameter, double value);
  void bind(int parameter, const std::string& value);
  void bind_null(int parameter);

  /// Goes to the next row; false at the end.
  bool step();
  /// Back to before the first row; what is bound stays.
  void reset();

  std::int64_t integer(int column) const;
  std::string text(int column) const;
  /// Text as it is, numbers as the shortest decimal that reads back as the same one, "" for NULL.
  std::string value_text(int column) const;

 private:
  Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

/// A name as SQL writes it: "pipeline.warp" in quotes.
std::string sql_name(const std::string& name);

/// BEGIN now; rolled back at the end unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace brace
