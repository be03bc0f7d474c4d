#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/time.hpp"
#include "runtime/timeline/job_record.hpp"

namespace brace {

/// A GPU's costs, linear in counted work: base of the job's kind plus a price per item. Nanoseconds.
struct CostModel {
  std::string name;
  std::string summary;  // one line for `brace list costs`
  struct Base {
    double cast = 0, warp = 0, update = 0;
    bool operator==(const Base&) const = default;
  } base_ns;
  struct Item {
    double ray = 0, sample = 0, skip_step = 0, shading_fetch = 0, texel = 0, byte = 0;
    bool operator==(const Item&) const = default;
  } item_ns;
};

/// Duration of a job, nearest nanosecond.
/// `share`: of an eye frame cast in cells; the base is divided among them.
SimDuration evaluate(const CostModel& model, JobKind kind, const WorkCounts& work, double share = 1.0);

/// Reads a model file (share/brace/costs/NAME.toml); every coefficient must be there, finite and >= 0.
/// Throws input_error naming file, line and key.
CostModel read_cost_model(const std::filesystem::path& file);

/// The models in a folder, sorted by name.
std::vector<std::string> cost_model_names(const std::filesystem::path& folder);

/// By name from a folder; throws input_error that lists the models and the nearest name.
CostModel find_cost_model(const std::filesystem::path& folder, const std::string& name);

/// A measured job to fit a model to.
struct CostSample {
  JobKind kind = JobKind::cast;
  WorkCounts work{};
  SimDuration time{0};
};

struct CostFit {
  CostModel model;
  double rms_relative_error = 0;  // over the samples
  double max_relative_error = 0;
  std::vector<std::string> unobserved;  // coefficients no sample could tell; they are 0
};

/// Non-negative least squares on relative errors (each sample weighted by 1/time). Throws input_error if
/// there are no samples with a time above zero.
CostFit fit_cost_model(std::span<const CostSample> samples, const std::string& name);

/// A model as the text of a file that read_cost_model reads.
std::string to_toml(const CostModel& model);

}  // namespace brace
