#pragma once

#include <filesystem>
#include <string>

#include "runtime/session/session_table.hpp"

namespace brace {

/// A preset's name as it is, a file as an absolute path.
std::string transfer_function_from(const std::filesystem::path& folder, const std::string& name);

/// Reads [[scene.transfer_change]] and scene.transfer_animation into `scene`.
void read_transfer_changes(const SessionTable& table, const std::filesystem::path& folder,
                           Session::Scene& scene);

/// Puts the absolute paths of the changes into the resolved session.
void write_absolute_transfer_changes(SessionTable& table, const Session::Scene& scene);

}  // namespace brace
