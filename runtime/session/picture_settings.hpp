#pragma once

#include <string>

#include "runtime/session/session.hpp"

namespace brace {

/// The resolved session without what has no part in an ideal picture from a given pose: trace, gaze, clock,
/// run, plan, and the stages around cast and skip. As long as the files that it names stay as they are, equal
/// texts mean equal ideal pictures from equal poses.
std::string picture_settings(const Session& session);

}  // namespace brace
