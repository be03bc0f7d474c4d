#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/time.hpp"
#include "plugins/abi/brace_stage.h"
#include "runtime/timeline/cost_model.hpp"
#include "runtime/timeline/job_record.hpp"

namespace brace {

/// A job whose duration is asked for, as it is submitted.
struct CostQuery {
  JobKind kind = JobKind::cast;
  std::int64_t index = 0;      // eye frame or vsync
  SimDuration elapsed{0};      // submission, since the run's start
  WorkCounts work{};           // as rendered
  SimDuration device_time{0};  // measured on the device at hand; zero if nothing ran
  double share = 1.0;          // of an eye frame cast in cells: this cell's part, for what has no counts
};

/// Where the durations of jobs on the simulated GPU come from. Called once per job in order of submission;
/// does not allocate.
class CostSource {
 public:
  virtual ~CostSource() = default;
  /// Never negative. Throws input_error when the source has none (a recording that has ended).
  virtual SimDuration cost(const CostQuery& query) = 0;
  /// False if two runs may differ.
  virtual bool deterministic() const = 0;
};

/// From as rendered to the profile's full resolution: rays, samples, skip steps, fetches and texels times
/// `pixel_scale` (nearest integer), bytes unchanged. `cost_resolution = "full"` at a resolution scale s means
/// pixel_scale = 1/s^2; "as_rendered" means 1.
WorkCounts scale_pixel_work(const WorkCounts& work, double pixel_scale);

/// In all of these `scale` multiplies every duration (clock.cost_scale) and must be finite and > 0.

/// The device at hand: not deterministic. The picture's resolution is the rendered one.
std::unique_ptr<CostSource> make_measured_cost(double scale);

std::unique_ptr<CostSource> make_model_cost(const CostModel& model, double pixel_scale, double scale);

/// costs.csv of an earlier run, given its directory or the file: the n-th job of each kind costs what the
/// n-th job of this kind (ordered by frame or vsync) cost then. Unfinished jobs are part of the recording, so
/// the same session gives the same timeline. A job beyond the recording's end is an input_error.
std::unique_ptr<CostSource> make_recorded_cost(const std::filesystem::path& run, double scale);
std::unique_ptr<CostSource> make_recorded_cost(std::vector<JobRecord> jobs, const std::string& name,
                                               double scale);

/// Constant costs from `from_s` seconds after the run's start until the next segment, for load steps.
struct CostSegment {
  double from_s = 0.0;
  double cast_ms = 0.0;
  double warp_ms = 0.0;
  double update_ms = 0.0;
};
/// Segments in increasing from_s, the first at 0; throws input_error otherwise.
std::unique_ptr<CostSource> make_scripted_cost(const std::vector<CostSegment>& segments, double scale);

/// A plug-in's cost stage. `functions` and `self` are not owned and must outlive the source. A call that
/// fails or returns a negative duration is a device_error that names `name`.
std::unique_ptr<CostSource> make_plugin_cost(const brace_cost_functions& functions, void* self,
                                             const std::string& name, double pixel_scale, double scale);

}  // namespace brace
