#include "runtime/verify/verify_page.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/report/output_file.hpp"
#include "runtime/report/page.hpp"
#include "runtime/report/text_file.hpp"
#include "runtime/verify/svg_plot.hpp"

namespace brace {

namespace {

std::string tile(const std::string& name, const std::string& value, const std::string& more,
                 bool bad = false) {
  return fmt::format(
      "<div class='tile{}'><div class='name'>{}</div><div class='value'>{}</div><div "
      "class='more'>{}</div></div>",
      bad ? " bad" : "", name, value, more);
}

std::string unit_text(const Claim& claim) {
  return claim.unit.empty() ? std::string() : fmt::format(" {}", html_text(claim.unit));
}

std::string claims_table(const VerifyReport& report, const std::string& group) {
  std::string rows;
  for (const Claim& claim : report.claims) {
    if (claim.group != group) continue;
    rows +=
        fmt::format("<tr{}><td>{}</td><td>{}{}</td><td>{}</td><td>{}</td></tr>",
                    claim.passed ? "" : " class='failed'", html_text(claim.claim), figure_text(claim.figure),
                    unit_text(claim), to_string(claim.bound), claim.passed ? "pass" : "FAIL");
  }
  return fmt::format(
      "<div class='scroll'><table class='claims'><thead><tr><th>Claim</th><th>Figure</th><th>Bound</th>"
      "<th>Result</th></tr></thead><tbody>{}</tbody></table></div>",
      rows);
}

std::string curves_of(const VerifyReport& report, bool adaptive) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<const ErrorCurve*>> by_problem;
  for (const ErrorCurve& curve : report.figures.curves) {
    if ((curve.rule == "fixed steps" || curve.rule == "adaptive steps") != adaptive) continue;
    if (by_problem[curve.problem].empty()) order.push_back(curve.problem);
    by_problem[curve.problem].push_back(&curve);
  }
  std::string text = "<div class='plots'>";
  for (const std::string& problem : order)
    text += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>", error_plot(by_problem[problem]),
                        html_text(problem));
  return text + "</div>";
}

std::string figures_of(const VerifyReport& report, const std::string& group) {
  if (group == "integrators") return curves_of(report, false);
  if (group == "adaptive") return curves_of(report, true);
  if (group != "stability" || report.figures.stability.empty()) return "";
  std::vector<const StabilityRow*> rows;
  for (const StabilityRow& row : report.figures.stability)
    rows.push_back(&row);
  return fmt::format(
      "<div class='scroll'>{}</div><p class='quiet'>Darker: larger error of what a slab shows, from 10⁻⁸ to "
      "0.1. "
      "Crossed: negative, above what the medium can show, or not a number.</p>",
      stability_map(rows));
}

constexpr const char* kStyle =
    ".claims td, .claims th { white-space: normal; vertical-align: top; } .claims td:first-child { color: "
    "var(--text); }"
    ".claims th:nth-child(n+2), .claims td:nth-child(n+2) { white-space: nowrap; }"
    "tr.failed td { color: var(--bad); font-weight: 600; }"
    ".plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 420px), 1fr)); gap: "
    "14px;"
    " margin-bottom: 12px; } .plots figure { max-width: 560px; width: 100%; margin: 0 auto; } .plots figure "
    "> svg { width: 100%; height: auto; } .legend svg { width: 14px; }"
    ".legend { justify-content: center; } .card > h2 + .quiet { margin: 0 0 10px; } .device { margin: -10px "
    "0 12px; }";

// The colours follow the system's preference until the button is pressed.
constexpr const char* kScript =
    "const root=document.documentElement,button=document.getElementById('theme');"
    "const show=dark=>{root.dataset.theme=dark?'dark':'light';button.textContent=dark?'Light':'Dark';};"
    "show(matchMedia('(prefers-color-scheme: dark)').matches);"
    "button.addEventListener('click',()=>show(root.dataset.theme!=='dark'));";

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::size_t VerifyReport::failed() const {
  return static_cast<std::size_t>(
      std::count_if(claims.begin(), claims.end(), [](const Claim& claim) { return !claim.passed; }));
}

std::string to_json(const VerifyReport& report) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const Claim& claim : report.claims) {
    lines.push_back({{"group", claim.group},
                     {"claim", claim.claim},
                     {"figure", number(claim.figure)},
                     {"unit", claim.unit},
                     {"low", number(claim.bound.low)},
                     {"high", number(claim.bound.high)},
                     {"passed", claim.passed}});
  }
  return nlohmann::ordered_json{{"passed", report.failed() == 0}, {"failed", report.failed()},
                                {"device", report.device},        {"version", report.version},
                                {"seconds", report.seconds},      {"claims", std::move(lines)}}
      .dump(2);
}

void write_verify_page(const std::filesystem::path& path, const VerifyReport& report,
                       const std::filesystem::path& page_folder) {
  OutputFile file(path);
  file.write(page_head(page_folder, "Numerical verification"));
  file.write(fmt::format("<style>{}</style><main><p class='quiet device'>Brace {} on {}</p>", kStyle,
                         html_text(report.version), html_text(report.device)));
  const std::size_t failed = report.failed();
  file.write("<section class='tiles' aria-label='Headline figures'>");
  file.write(tile("Claims", std::to_string(report.claims.size()), "each with a figure and a bound"));
  file.write(tile("Failed", std::to_string(failed), failed == 0 ? "all hold" : "marked below", failed != 0));
  file.write(tile("Run time", fmt::format("{:.1f} <small>s</small>", report.seconds), "on this machine"));
  file.write("</section>");
  for (const VerifyGroup& group : verify_groups()) {
    const bool there = std::any_of(report.claims.begin(), report.claims.end(),
                                   [&](const Claim& claim) { return claim.group == group.name; });
    if (!there) continue;
    file.write(fmt::format("<section class='card'><h2>{}</h2><p class='quiet'>{}.</p>", group.name,
                           html_text(group.about)));
    file.write(figures_of(report, group.name));
    file.write(claims_table(report, group.name));
    file.write("</section>");
  }
  file.write(
      "</main><footer class='quiet'>Self-contained page: no network is used. Colours: Okabe and Ito's "
      "palette, "
      "distinguishable with colour-vision deficiencies.</footer><script>");
  file.write(kScript);
  file.write("</script></body></html>\n");
  file.close();
}

}  // namespace brace
