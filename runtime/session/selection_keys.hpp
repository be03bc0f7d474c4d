#pragma once

#include "runtime/session/session.hpp"
#include "runtime/session/session_table.hpp"

namespace brace {

/// A key that names vsyncs: every:N, list:A,B,..., ends or none.
Session::Output::Selection read_selection(const SessionTable& table, const char* key);

}  // namespace brace
