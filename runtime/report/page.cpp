#include "runtime/report/page.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "runtime/report/output_file.hpp"
#include "runtime/report/page_data.hpp"
#include "runtime/report/text_file.hpp"

namespace brace {

namespace {

// JSON inside a <script> element: no "<" may stay, or "</script>" in a string would end the element.
std::string script_safe(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

// What stands for "{{name}}" in the template.
std::string part(std::string_view name, const ReportInput& input, const std::filesystem::path& page_folder,
                 const std::filesystem::path& pictures_folder) {
  if (name == "style") return read_text_file(page_folder / "report.css");
  if (name == "chart_library") return read_text_file(page_folder / "chart.min.js");
  if (name == "charts") return read_text_file(page_folder / "charts.js");
  if (name == "script") return read_text_file(page_folder / "report.js");
  if (name == "data") return script_safe(page_data(input, pictures_folder));
  throw input_error("{}: unknown placeholder '{}'; accepted: style, chart_library, charts, script, data",
                    (page_folder / "report.html").string(), name);
}

}  // namespace

std::string read_text_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(path, ignored)) {
    throw input_error("{}: cannot be read: no such file, or not readable", path.string());
  }
  return text;
}

void write_page(const std::filesystem::path& path, const ReportInput& input,
                const std::filesystem::path& page_folder, const std::filesystem::path& pictures_folder) {
  const std::string page = read_text_file(page_folder / "report.html");
  OutputFile file(path);
  std::string_view rest = page;
  for (std::size_t begin; (begin = rest.find("{{")) != std::string_view::npos;) {
    const std::size_t end = rest.find("}}", begin);
    if (end == std::string_view::npos) break;
    file.write(rest.substr(0, begin));
    file.write(part(rest.substr(begin + 2, end - begin - 2), input, page_folder, pictures_folder));
    rest.remove_prefix(end + 2);
  }
  file.write(rest);
  file.close();
}

}  // namespace brace
