#include "runtime/compare/compare_records.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/error.hpp"
#include "base/suggest.hpp"

namespace brace {

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

double milliseconds(std::int64_t ns) {
  return ns < 0 ? no_value : static_cast<double>(ns) * 1e-6;
}

double degrees(double rad) {
  return rad * (180.0 / std::numbers::pi);
}

bool shows(const FrameRecord& record) {
  return record.displayed_frame >= 0;
}

// Value of a record, NaN where there is none.
using ValueOf = double (*)(const FrameRecord&);

double missed_of(const FrameRecord& r) {
  return r.missed || !shows(r) ? 1.0 : 0.0;
}
double mtp_rotation_of(const FrameRecord& r) {
  return milliseconds(r.mtp_rotation_ns);
}
double mtp_translation_of(const FrameRecord& r) {
  return milliseconds(r.mtp_translation_ns);
}
double frame_age_of(const FrameRecord& r) {
  return milliseconds(r.frame_age_ns);
}
double angular_error_of(const FrameRecord& r) {
  return degrees(r.angular_error_rad);
}
double position_error_of(const FrameRecord& r) {
  return r.position_error_m * 1e3;
}
double dssim_left_of(const FrameRecord& r) {
  return r.dssim_left;
}
double dssim_right_of(const FrameRecord& r) {
  return r.dssim_right;
}
double samples_of(const FrameRecord& r) {
  return shows(r) ? static_cast<double>(r.work.samples) : no_value;
}

struct Figure {
  const char* name;
  std::vector<ValueOf> values;  // one, or one per eye
  bool has_tail;                // p99 beside the mean
  bool needs_pose;              // nothing is known where the trace has a gap
  Tolerance tolerance;          // unless the user asks for another
};

const std::vector<Figure>& figures() {
  static const std::vector<Figure> all = {
      {"missed_ratio", {missed_of}, false, false, {0.005, 0}},
      {"mtp_rotation_ms", {mtp_rotation_of}, true, true, {0.1, 0.01}},
      {"mtp_translation_ms", {mtp_translation_of}, true, true, {0.1, 0.01}},
      {"frame_age_ms", {frame_age_of}, true, true, {0.1, 0.01}},
      {"angular_error_deg", {angular_error_of}, true, true, {0.02, 0.01}},
      {"position_error_mm", {position_error_of}, true, true, {0.1, 0.01}},
      {"dssim", {dssim_left_of, dssim_right_of}, true, true, {0.001, 0.01}},
      {"samples", {samples_of}, false, false, {0, 0.01}},
  };
  return all;
}

using Pair = std::pair<const FrameRecord*, const FrameRecord*>;

/// Both in ascending order of vsync_index.
std::vector<Pair> paired(std::span<const FrameRecord> a, std::span<const FrameRecord> b) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].vsync_index < b[j].vsync_index) {
      ++i;
    } else if (b[j].vsync_index < a[i].vsync_index) {
      ++j;
    } else {
      pairs.emplace_back(&a[i++], &b[j++]);
    }
  }
  return pairs;
}

void require_pairs(const std::vector<Pair>& pairs) {
  if (pairs.empty()) throw input_error("the runs have no vsync in common: there is nothing to compare");
  for (const auto& [a, b] : pairs) {
    if (a->vsync_ns == b->vsync_ns) continue;
    throw input_error(
        "vsync {} is at {} ns in A and at {} ns in B: runs of different refresh rates cannot be compared "
        "vsync "
        "by vsync",
        a->vsync_index, a->vsync_ns, b->vsync_ns);
  }
}

struct PairedValues {
  std::vector<double> a, b;
  bool any_a = false, any_b = false;
};

PairedValues values_of(const Figure& figure, const std::vector<Pair>& pairs) {
  PairedValues values;
  for (const auto& [a, b] : pairs) {
    if (!shows(*a) && !shows(*b)) continue;
    if (figure.needs_pose && !(a->pose_valid && b->pose_valid)) continue;
    for (const ValueOf value_of : figure.values) {
      const double value_a = value_of(*a), value_b = value_of(*b);
      values.any_a = values.any_a || std::isfinite(value_a);
      values.any_b = values.any_b || std::isfinite(value_b);
      if (!std::isfinite(value_a) || !std::isfinite(value_b)) continue;
      values.a.push_back(value_a);
      values.b.push_back(value_b);
    }
  }
  return values;
}

FigureComparison compare_statistic(const Figure& figure, const char* name, Statistic statistic,
                                   const PairedValues& values, bool deterministic,
                                   const CompareOptions& options) {
  FigureComparison comparison;
  comparison.figure = figure.name;
  comparison.statistic = name;
  comparison.pairs = paired_difference(values.a, values.b, statistic, options.bootstrap);
  comparison.tolerance =
      tolerance_of(options.tolerances, figure.name, name, figure.tolerance).of(comparison.pairs.a);
  comparison.verdict = verdict_of(comparison.pairs, comparison.tolerance, deterministic);
  return comparison;
}

void require_not_asked_for(const Figure& figure, const CompareOptions& options) {
  for (const ToleranceChoice& choice : options.tolerances) {
    if (choice.figure != figure.name) continue;
    throw input_error(
        "--tolerance {}: the runs have no vsync at which both have this figure; it cannot be checked",
        figure.name);
  }
}

}  // namespace

Verdict verdict_of(const PairedDifference& pairs, double tolerance, bool deterministic) {
  if (std::abs(pairs.difference) <= tolerance) return Verdict::same;
  const bool worse = pairs.difference > 0;
  const bool certain = worse ? pairs.lower > tolerance : pairs.upper < -tolerance;
  if (!deterministic && !certain) return Verdict::unclear;
  return worse ? Verdict::worse : Verdict::better;
}

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::same:
      return "same";
    case Verdict::better:
      return "better";
    case Verdict::worse:
      return "worse";
    case Verdict::unclear:
      return "unclear";
  }
  BRACE_CHECK(false);
}

RecordsComparison compare_records(std::span<const FrameRecord> a, std::span<const FrameRecord> b,
                                  bool deterministic, const CompareOptions& options) {
  const std::vector<Pair> pairs = paired(a, b);
  require_pairs(pairs);
  RecordsComparison result;
  result.vsyncs_paired = pairs.size();
  result.vsyncs_only_a = a.size() - pairs.size();
  result.vsyncs_only_b = b.size() - pairs.size();
  for (const Figure& figure : figures()) {
    const PairedValues values = values_of(figure, pairs);
    if (values.a.empty()) {
      require_not_asked_for(figure, options);
      if (values.any_a) result.only_a.emplace_back(figure.name);
      if (values.any_b) result.only_b.emplace_back(figure.name);
      continue;
    }
    result.figures.push_back(compare_statistic(figure, "mean", {0}, values, deterministic, options));
    if (!figure.has_tail) continue;
    result.figures.push_back(compare_statistic(figure, "p99", {99}, values, deterministic, options));
  }
  return result;
}

void require_compared_figure(const std::string& who, const std::string& name, const std::string& statistic) {
  std::vector<std::string> names;
  for (const Figure& figure : figures()) {
    names.emplace_back(figure.name);
    if (figure.name != name) continue;
    if (statistic.empty() || statistic == "mean" || (statistic == "p99" && figure.has_tail)) return;
    throw input_error("{}: figure '{}' has no '{}'; accepted: {}", who, name, statistic,
                      figure.has_tail ? "mean, p99" : "mean");
  }
  throw input_error("{}: unknown figure '{}'{}; accepted: {}", who, name, did_you_mean(name, names),
                    join(names));
}

}  // namespace brace
