#pragma once

#include "runtime/session/session.hpp"
#include "runtime/session/session_table.hpp"

namespace brace {

/// The keys of [gaze].
Session::Gaze read_gaze(const SessionTable& table);

}  // namespace brace
