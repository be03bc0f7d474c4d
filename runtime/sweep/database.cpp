#include "runtime/sweep/database.hpp"

#include <sqlite3.h>

#include "base/error.hpp"

namespace brace {

namespace {
constexpr int busy_wait_ms = 60'000;
}

Database::Database(std::filesystem::path file) : file_(std::move(file)) {
  const int code =
      sqlite3_open_v2(file_.c_str(), &handle_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  if (code == SQLITE_OK) {
    // Whoever looks at the results while a sweep goes on holds them for a moment.
    sqlite3_busy_timeout(handle_, busy_wait_ms);
    return;
  }
  const std::string reason = sqlite3_errstr(code);
  sqlite3_close(handle_);
  throw input_error("{}: {}; choose a folder you may write to with --out", file_.string(), reason);
}

Database::~Database() {
  sqlite3_close(handle_);
}

void Database::fail(int code) const {
  const std::string reason = sqlite3_errmsg(handle_);
  if ((code & 0xff) == SQLITE_FULL || (code & 0xff) == SQLITE_IOERR)
    throw device_error("{}: {}; free some space or choose another folder with --out", file_.string(), reason);
  if ((code & 0xff) == SQLITE_BUSY)
    throw device_error("{}: another program holds it; once it has let go, the same command goes on",
                       file_.string());
  throw input_error("{}: {}; accepted: the results of a sweep of this version, or a new folder with --out",
                    file_.string(), reason);
}

void Database::execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

Statement::Statement(Database& database, const std::string& sql) : database_(database) {
  const int code = sqlite3_prepare_v2(database.handle_, sql.c_str(), -1, &handle_, nullptr);
  if (code != SQLITE_OK) database.fail(code);
}

Statement::~Statement() {
  sqlite3_finalize(handle_);
}

void Statement::bind(int parameter, std::int64_t value) {
  BRACE_CHECK(sqlite3_bind_int64(handle_, parameter, value) == SQLITE_OK);
}

void Statement::bind(int parameter, double value) {
  BRACE_CHECK(sqlite3_bind_double(handle_, parameter, value) == SQLITE_OK);
}

void Statement::bind(int parameter, const std::string& value) {
  // SQLITE_TRANSIENT casts an integer to a function pointer; the length makes the text's end explicit.
  const int code =
      sqlite3_bind_text64(handle_, parameter, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  if (code != SQLITE_OK) database_.fail(code);
}

void Statement::bind_null(int parameter) {
  BRACE_CHECK(sqlite3_bind_null(handle_, parameter) == SQLITE_OK);
}

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail(code);
  return code == SQLITE_ROW;
}

void Statement::reset() {
  sqlite3_reset(handle_);
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(handle_, column);
}

std::string Statement::text(int column) const {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(handle_, column));
  const int size = sqlite3_column_bytes(handle_, column);
  return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
}

std::string Statement::value_text(int column) const {
  if (sqlite3_column_type(handle_, column) != SQLITE_FLOAT) return text(column);
  return fmt::format("{}", sqlite3_column_double(handle_, column));
}

std::string sql_name(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

Transaction::Transaction(Database& database) : database_(database) {
  database.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.execute("ROLLBACK");
  } catch (const Error&) {  // it has rolled back by itself
  }
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace brace
