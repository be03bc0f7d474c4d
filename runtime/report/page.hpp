#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "runtime/report/report_input.hpp"

namespace brace {

// What the page holds of a long run; it says so where it leaves something out.
inline constexpr std::size_t page_curve_points = 1200;  // per curve, peaks kept (decimate.hpp)
inline constexpr std::size_t page_timeline_vsyncs =
    4000;                                               // in the frame timeline, around the longest stale run
inline constexpr std::size_t page_picture_vsyncs = 12;  // with both eyes' pictures, evenly spread

/// report.html: one file that needs no network. Assembled from the template in `page_folder` (head.html,
/// report.html, report.css, charts.js, report.js, chart.min.js); relative picture paths are taken from
/// `pictures_folder`. Throws brace::Error naming a template file or picture that cannot be read (exit code
/// 2).
void write_page(const std::filesystem::path& path, const ReportInput& input,
                const std::filesystem::path& page_folder, const std::filesystem::path& pictures_folder);

/// What every page begins with, up to and with its <header>: page_folder/head.html with the style of
/// report.css. The title is HTML.
std::string page_head(const std::filesystem::path& page_folder, const std::string& title);

/// A page from any template: every {{name}} becomes the part of that name. Throws brace::Error for a template
/// that cannot be read or asks for another part.
void write_template(const std::filesystem::path& path, const std::filesystem::path& page,
                    const std::map<std::string, std::string, std::less<>>& parts);

/// JSON as it may stand inside a <script> element.
std::string script_safe(const std::string& json);

}  // namespace brace
