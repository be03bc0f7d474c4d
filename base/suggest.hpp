#pragma once

#include <span>
#include <string>
#include <string_view>

namespace brace {

/// Number of single-character insertions, deletions, substitutions and swaps of neighbours between two words.
int edit_distance(std::string_view a, std::string_view b);

/// " (did you mean 'x'?)" for the candidate nearest to `word`, or "" if none is near. For error messages.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// "a, b, c".
std::string join(std::span<const std::string> words, std::string_view separator = ", ");

}  // namespace brace
