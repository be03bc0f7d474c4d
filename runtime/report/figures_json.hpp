#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "runtime/report/report_input.hpp"

namespace brace {

// Parts that summary.json and the page share. Include from .cpp files only: nlohmann's header is heavy.

using Json = nlohmann::ordered_json;

/// NaN as null, infinity as "inf" or "-inf".
Json real(double value);

/// {"family": "family/name", …}
Json pipeline_json(const RunSeries& series);
Json left_out_json(const RunSeries& series);
Json faults_json(const RunSeries& series);
/// {"name": "value", …}
Json facts_json(std::span<const Fact> facts);
Json clock_json(const ClockInfo& clock);
Json host_json(const HostFigures& host);

/// "vsyncs" … "dssim": the figures of one series' records.
Json figures_json(const RunSeries& series);

}  // namespace brace
