#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "runtime/compare/bootstrap.hpp"
#include "runtime/compare/tolerance.hpp"
#include "runtime/metrics/frame_record.hpp"

namespace brace {

enum class Verdict {
  same,     // within the tolerance
  better,   // B is lower than A by more than the tolerance
  worse,    // B is higher than A by more than the tolerance: the check fails
  unclear,  // beyond the tolerance, but measured, and the interval reaches into it: does not fail
};
const char* verdict_name(Verdict verdict);

/// One statistic of one figure. Every figure is better when it is lower.
struct FigureComparison {
  std::string figure;     // "mtp_rotation_ms": the unit is the last part of the name
  std::string statistic;  // "mean" or "p99"
  PairedDifference pairs;
  double tolerance = 0;  // in the figure's unit
  Verdict verdict = Verdict::same;
};

struct CompareOptions {
  BootstrapOptions bootstrap;
  std::vector<ToleranceChoice> tolerances;
};

struct RecordsComparison {
  std::size_t vsyncs_paired = 0, vsyncs_only_a = 0, vsyncs_only_b = 0;
  std::vector<FigureComparison> figures;
  std::vector<std::string> only_a, only_b;  // figures that the other side has no value of
};

/// Compares vsync by vsync: missed_ratio, mtp_rotation_ms, mtp_translation_ms, frame_age_ms,
/// angular_error_deg, position_error_mm, dssim (both eyes) and samples (of the eye frame shown). A vsync
/// before a run's first image counts as missed where the other run shows one already. Vsyncs in a gap of the
/// trace count for misses alone.
///
/// `deterministic`: both runs are. Then their difference is exact and is held against the tolerance as it is;
/// the interval says how it varies along the trace. Otherwise B is worse (or better) only if the whole
/// interval lies beyond the tolerance.
///
/// Throws input_error where the runs have no vsync in common, where vsyncs of the same index are not at the
/// same time (another refresh rate), and where a tolerance was asked for a figure that only one of them has.
RecordsComparison compare_records(std::span<const FrameRecord> a, std::span<const FrameRecord> b,
                                  bool deterministic, const CompareOptions& options);

/// Worse or better beyond the tolerance; where costs were measured only if the whole interval is.
Verdict verdict_of(const PairedDifference& pairs, double tolerance, bool deterministic);

/// Throws input_error, beginning with `who`, unless there is such a figure; statistic "" is any.
void require_compared_figure(const std::string& who, const std::string& figure, const std::string& statistic);

}  // namespace brace
