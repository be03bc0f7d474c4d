#include "runtime/session/selection_keys.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "base/error.hpp"

namespace brace {

Session::Output::Selection read_selection(const SessionTable& table, const char* key) {
  using Kind = Session::Output::Selection::Kind;
  const std::string text = table.text(key);
  const auto wrong = [&]() {
    table.fail(key, fmt::format("is '{}'; accepted: every:N, list:A,B,…, ends, none", text));
  };
  const auto number = [&](const std::string& digits) {
    std::int64_t value = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value < 0) wrong();
    return value;
  };
  Session::Output::Selection selection;
  if (text == "none") return selection;
  if (text == "ends") {
    selection.kind = Kind::ends;
  } else if (text.rfind("every:", 0) == 0) {
    selection.kind = Kind::every;
    selection.every = number(text.substr(6));
    if (selection.every == 0) wrong();
  } else if (text.rfind("list:", 0) == 0) {
    selection.kind = Kind::list;
    std::istringstream stream(text.substr(5));
    for (std::string part; std::getline(stream, part, ',');)
      selection.list.push_back(number(part));
    if (selection.list.empty()) wrong();
    std::sort(selection.list.begin(), selection.list.end());
  } else {
    wrong();
  }
  return selection;
}

}  // namespace brace
