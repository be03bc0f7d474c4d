#pragma once

#include "runtime/replay/headset.hpp"
#include "runtime/report/report_input.hpp"

namespace brace {

/// Error of the session's predictor against the true head over the whole trace, per horizon.
ReportTable prediction_table(const Session& session, const HeadTrace& head_trace, const Headset& headset);

}  // namespace brace
