#include <fmt/format.h>

#include "base/error.hpp"
#include "runtime/compare/compare_sweeps.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

CompareOptions options_of(const CompareCommand& command) {
  CompareOptions options;
  options.bootstrap.seed = command.seed;
  options.bootstrap.resamples = command.resamples;
  options.bootstrap.confidence = command.confidence;
  for (const std::string& text : command.tolerances)
    options.tolerances.push_back(parse_tolerance(text));
  return options;
}

void print_figure(const FigureComparison& figure) {
  const PairedDifference& pairs = figure.pairs;
  fmt::print(
      "  {:<24}{:>12.5g}{:>12.5g}{:>+12.4g}  [{:+.4g}, {:+.4g}]{:>{}}  {:<9}\n",
      figure.figure + (figure.statistic == "mean" ? "" : " " + figure.statistic), pairs.a, pairs.b,
      pairs.difference, pairs.lower, pairs.upper, fmt::format("{:.3g}", figure.tolerance),
      std::max<std::size_t>(10, 34 - fmt::formatted_size("[{:+.4g}, {:+.4g}]", pairs.lower, pairs.upper)),
      verdict_name(figure.verdict));
}

void print_series(const SeriesComparison& series, const char* unit, const CompareCommand& command) {
  const RecordsComparison& records = series.records;
  if (!series.label.empty()) fmt::print("{}\n", series.label);
  fmt::print("  {} {} in both; only in A: {}, only in B: {}\n", records.vsyncs_paired, unit,
             records.vsyncs_only_a, records.vsyncs_only_b);
  fmt::print("  {:<24}{:>12}{:>12}{:>12}  {:<24}{:>10}  verdict\n", "figure (mean or p99)", "A", "B", "B - A",
             fmt::format("{:g} % interval", 100.0 * command.confidence), "tolerance");
  for (const FigureComparison& figure : records.figures)
    print_figure(figure);
  for (const std::string& name : records.only_a)
    fmt::print("  {:<24}not compared: only A has it\n", name);
  for (const std::string& name : records.only_b)
    fmt::print("  {:<24}not compared: only B has it\n", name);
}

void print_comparison(const RunsComparison& comparison, const CompareCommand& command) {
  fmt::print("A  {}\nB  {}\n", command.a.string(), command.b.string());
  for (const Difference& one : comparison.differences)
    fmt::print("   {}: {} in A, {} in B\n", one.name, one.a, one.b);
  for (const SeriesComparison& one : comparison.series)
    print_series(one, comparison.unit, command);
  for (const std::string& label : comparison.labels_only_a)
    fmt::print("{}: not compared: only A has this series\n", label);
  for (const std::string& label : comparison.labels_only_b)
    fmt::print("{}: not compared: only B has this series\n", label);
  if (!comparison.deterministic) {
    fmt::print("Measured costs: worse means that the whole interval lies beyond the tolerance.\n");
  }
  fmt::print("{}\n", comparison.passed() ? "passed" : "FAILED: B is worse than A beyond the tolerance");
}

}  // namespace

int compare_command(const CompareCommand& command) {
  const CompareOptions options = options_of(command);
  const RunsComparison comparison = is_sweep(command.a) || is_sweep(command.b)
                                        ? compare_sweeps(command.a, command.b, options)
                                        : compare_runs(command.a, command.b, options);
  if (command.json) {
    fmt::print("{}\n", comparison_json(comparison, command.a, command.b, options));
  } else {
    print_comparison(comparison, command);
  }
  return static_cast<int>(comparison.passed() ? ExitCode::done : ExitCode::check_failed);
}

}  // namespace brace
