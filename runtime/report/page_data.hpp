#pragma once

#include <filesystem>

#include "runtime/report/figures_json.hpp"

namespace brace {

/// Everything report.js shows, decimated to a size that does not grow with the run. Times in the curves are
/// counted from the first vsync. See page.hpp for the limits.
Json page_data(const ReportInput& input, const std::filesystem::path& pictures_folder);

}  // namespace brace
