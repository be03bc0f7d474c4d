#pragma once

#include <string>

#include "runtime/session/session.hpp"

namespace brace::test {

/// The smallest session that is complete.
inline const std::string smallest = R"(
[trace]
file = "walk.csv"
[scene]
volume = "head.nrrd"
)";

/// Every family's default stages, warp/grid with a parameter of each type, and rays/mab's levels.
StageRegistry session_stages();

/// Parses text as "s.toml" in the folder /sessions.
Session parse(const std::string& text, const Overrides& overrides = {});

/// The message of the input error that parsing gives, "" if there is none; any other exception fails the
/// test.
std::string error_of(const std::string& text, const Overrides& overrides = {});

}  // namespace brace::test
