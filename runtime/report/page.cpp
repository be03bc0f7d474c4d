#include "runtime/report/page.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/report/output_file.hpp"
#include "runtime/report/page_data.hpp"
#include "runtime/report/text_file.hpp"

namespace brace {

std::string read_text_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(path, ignored)) {
    throw input_error("{}: cannot be read: no such file, or not readable", path.string());
  }
  return text;
}

// No "<" may stay, or "</script>" in a string would end the element.
std::string script_safe(const std::string& json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

namespace {

using Parts = std::map<std::string, std::string, std::less<>>;

/// The text of a template with every {{name}} replaced, handed to `write` in pieces.
template <typename Write>
void fill_template(const std::filesystem::path& page, const Parts& parts, const Write& write) {
  const std::string text = read_text_file(page);
  std::string_view rest = text;
  for (std::size_t begin; (begin = rest.find("{{")) != std::string_view::npos;) {
    const std::size_t end = rest.find("}}", begin);
    if (end == std::string_view::npos) break;
    const std::string_view name = rest.substr(begin + 2, end - begin - 2);
    const auto part = parts.find(name);
    if (part == parts.end()) {
      std::vector<std::string> names;
      for (const auto& [known, ignored] : parts)
        names.push_back(known);
      throw input_error("{}: unknown placeholder '{}'; accepted: {}", page.string(), name, join(names));
    }
    write(rest.substr(0, begin));
    write(part->second);
    rest.remove_prefix(end + 2);
  }
  write(rest);
}

}  // namespace

std::string page_head(const std::filesystem::path& page_folder, const std::string& title) {
  std::string head;
  fill_template(page_folder / "head.html",
                {{"title", title}, {"style", read_text_file(page_folder / "report.css")}},
                [&](std::string_view piece) { head += piece; });
  return head;
}

void write_template(const std::filesystem::path& path, const std::filesystem::path& page,
                    const std::map<std::string, std::string, std::less<>>& parts) {
  OutputFile file(path);
  fill_template(page, parts, [&](std::string_view piece) { file.write(piece); });
  file.close();
}

void write_page(const std::filesystem::path& path, const ReportInput& input,
                const std::filesystem::path& page_folder, const std::filesystem::path& pictures_folder) {
  const auto text = [&](const char* name) { return read_text_file(page_folder / name); };
  write_template(path, page_folder / "report.html",
                 {{"head", page_head(page_folder, "Brace run")},
                  {"chart_library", text("chart.min.js")},
                  {"charts", text("charts.js")},
                  {"script", text("report.js")},
                  {"data", script_safe(page_data(input, pictures_folder)
                                           .dump(-1, ' ', false, Json::error_handler_t::replace))}});
}

}  // namespace brace
