#pragma once

#include <string>
#include <vector>

#include "runtime/session/session.hpp"
#include "runtime/session/session_table.hpp"

namespace brace {

/// What a scene may not need, by the names of plan.leave_out and plan.keep, in the order of a frame.
const std::vector<std::string>& plan_items();

/// Reads [plan] and takes the items that it names out of the table: their stages become the plain ones of
/// their families, their parameters the ones that do without. An item that the session does not have is no
/// error. Throws input_error for unknown items, and for those both kept and left out.
Session::Plan read_plan(SessionTable& table, const StageRegistry& stages);

/// Whether the session has the item at all: a stage other than the plain one, a parameter that asks for it.
/// Those of the display, which the headset decides, are always there.
bool has_item(const Session& session, const std::string& item);

}  // namespace brace
