#pragma once

#include <filesystem>

#include "runtime/report/report_input.hpp"

namespace brace {

// What the page holds of a long run; it says so where it leaves something out.
inline constexpr std::size_t page_curve_points = 1200;  // per curve, peaks kept (decimate.hpp)
inline constexpr std::size_t page_timeline_vsyncs =
    4000;                                               // in the frame timeline, around the longest stale run
inline constexpr std::size_t page_picture_vsyncs = 12;  // with both eyes' pictures, evenly spread

/// report.html: one file that needs no network. Assembled from the template in `page_folder` (report.html,
/// report.css, charts.js, report.js, chart.min.js); relative picture paths are taken from `pictures_folder`.
/// Throws brace::Error naming a template file or picture that cannot be read (exit code 2).
void write_page(const std::filesystem::path& path, const ReportInput& input,
                const std::filesystem::path& page_folder, const std::filesystem::path& pictures_folder);

}  // namespace brace
