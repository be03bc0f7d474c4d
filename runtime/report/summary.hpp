#pragma once

#include <string>

#include "runtime/report/report_input.hpp"

namespace brace {

/// What summary.json's "format" says; a run directory is known by it.
inline constexpr const char* summary_format = "brace-run-1";

/// summary.json. Figures of the first series stand at the top; with several series "series" holds the same
/// keys for each. Only "host" may differ between equal runs. Real numbers are the shortest decimal that reads
/// back as the same double; a figure that does not exist (no picture was compared, no frame shown) is null.
/// JSON has no infinity: it is the string "inf".
std::string summary_json(const ReportInput& input);

}  // namespace brace
