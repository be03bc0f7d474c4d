#include "runtime/session/gaze_keys.hpp"

#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr double kGazeTanMax = 4.0;

}  // namespace

Session::Gaze read_gaze(const SessionTable& table) {
  Session::Gaze gaze;
  gaze.latency_ms = table.number_in("gaze.latency_ms", 0.0, 1000.0);
  const toml::node* node = table.node("gaze.script");
  if (node == nullptr) return gaze;
  for (const auto& entry : *node->as_array()) {
    const toml::array* point = entry.as_array();
    const bool is_point = point != nullptr && point->size() == 3 && (*point)[0].is_number() &&
                          (*point)[1].is_number() && (*point)[2].is_number();
    const auto number = [&](std::size_t i) {
      return (*point)[i].value<double>().value_or(std::numeric_limits<double>::infinity());
    };
    if (!is_point || !(number(0) >= 0.0 && number(0) <= 1e9) || !(std::abs(number(1)) <= kGazeTanMax) ||
        !(std::abs(number(2)) <= kGazeTanMax)) {
      throw input_error(
          "{}: an entry of 'gaze.script' is [seconds from 0, x, y], x and y tangents from {} to {}",
          place_of(entry, table.file()), -kGazeTanMax, kGazeTanMax);
    }
    gaze.script.push_back({number(0), number(1), number(2)});
    if (gaze.script.size() > 1 && gaze.script.back().at_s < gaze.script[gaze.script.size() - 2].at_s)
      throw input_error("{}: entries of 'gaze.script' are written in rising time",
                        place_of(entry, table.file()));
  }
  if (gaze.script.empty()) table.fail("gaze.script", "is empty; accepted: one entry or more");
  return gaze;
}

}  // namespace brace
