#include "runtime/timeline/cost_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "runtime/timeline/costs_csv.hpp"

namespace brace {

namespace {

SimDuration scaled(SimDuration duration, double scale) {
  const double ns = static_cast<double>(duration.count()) * scale;
  if (!(ns < 9e18))
    throw input_error("the cost of a job is beyond 2^63 ns: check the cost's scale and model");
  return scale == 1.0 ? duration : SimDuration(std::llround(ns));
}

double checked_scale(double scale) {
  if (!(std::isfinite(scale) && scale > 0))
    throw input_error("a cost's scale is {}; accepted: above 0", scale);
  return scale;
}

class MeasuredCost final : public CostSource {
 public:
  explicit MeasuredCost(double scale) : scale_(checked_scale(scale)) {}
  SimDuration cost(const CostQuery& query) override { return scaled(query.device_time, scale_); }
  bool deterministic() const override { return false; }

 private:
  double scale_;
};

class ModelCost final : public CostSource {
 public:
  ModelCost(const CostModel& model, double pixel_scale, double scale)
      : model_(model), pixel_scale_(checked_scale(pixel_scale)), scale_(checked_scale(scale)) {}
  SimDuration cost(const CostQuery& query) override {
    return scaled(evaluate(model_, query.kind, scale_pixel_work(query.work, pixel_scale_), query.share),
                  scale_);
  }
  bool deterministic() const override { return true; }

 private:
  CostModel model_;
  double pixel_scale_;
  double scale_;
};

class RecordedCost final : public CostSource {
 public:
  RecordedCost(std::vector<JobRecord> jobs, std::string name, double scale)
      : name_(std::move(name)), scale_(checked_scale(scale)) {
    std::stable_sort(jobs.begin(), jobs.end(),
                     [](const JobRecord& a, const JobRecord& b) { return a.index < b.index; });
    for (const JobRecord& job : jobs)
      track(job.kind).costs.push_back(SimDuration(job.cost_ns));
  }

  SimDuration cost(const CostQuery& query) override {
    Track& recorded = track(query.kind);
    if (recorded.next == recorded.costs.size()) {
      throw input_error(
          "{}: the recording has {} {} jobs and this run needs more at {:.3f} s; shorten the run (--frames) "
          "or "
          "record a longer one",
          name_, recorded.costs.size(), name_of(query.kind), to_s(query.elapsed));
    }
    return scaled(recorded.costs[recorded.next++], scale_);
  }
  bool deterministic() const override { return true; }

 private:
  struct Track {
    std::vector<SimDuration> costs;
    std::size_t next = 0;
  };
  Track& track(JobKind kind) { return tracks_[static_cast<std::size_t>(kind)]; }

  std::string name_;
  double scale_;
  std::array<Track, job_kind_count> tracks_;
};

class ScriptedCost final : public CostSource {
 public:
  ScriptedCost(const std::vector<CostSegment>& segments, double scale) {
    checked_scale(scale);
    if (segments.empty() || segments.front().from_s != 0.0) {
      throw input_error("scripted costs: the first segment must be there and have from_s = 0");
    }
    for (const CostSegment& segment : segments) {
      const auto duration = [&](const char* key, double ms) {
        if (!(ms >= 0 && ms <= 1e9))
          throw input_error("scripted costs: {} = {}; accepted: 0 to 1e9", key, ms);
        return scaled(from_s(ms * 1e-3), scale);
      };
      if (!(segment.from_s <= 1e9))
        throw input_error("scripted costs: from_s = {} is too late", segment.from_s);
      const SimDuration from = brace::from_s(segment.from_s);
      if (!segments_.empty() && from <= segments_.back().from) {
        throw input_error("scripted costs: from_s = {} does not come after the segment before it",
                          segment.from_s);
      }
      segments_.push_back({from,
                           {duration("cast_ms", segment.cast_ms), duration("warp_ms", segment.warp_ms),
                            duration("update_ms", segment.update_ms)}});
    }
  }

  SimDuration cost(const CostQuery& query) override {
    const auto after =
        std::upper_bound(segments_.begin(), segments_.end(), query.elapsed,
                         [](SimDuration elapsed, const Segment& segment) { return elapsed < segment.from; });
    const Segment& segment = after == segments_.begin() ? segments_.front() : *std::prev(after);
    return scaled(segment.costs[static_cast<std::size_t>(query.kind)], query.share);
  }
  bool deterministic() const override { return true; }

 private:
  struct Segment {
    SimDuration from;
    std::array<SimDuration, job_kind_count> costs;
  };
  std::vector<Segment> segments_;
};

class PluginCost final : public CostSource {
 public:
  PluginCost(const brace_cost_functions& functions, void* self, std::string name, double pixel_scale,
             double scale)
      : functions_(functions),
        self_(self),
        name_(std::move(name)),
        pixel_scale_(checked_scale(pixel_scale)),
        scale_(checked_scale(scale)) {
    BRACE_CHECK(functions.cost != nullptr);
  }

  SimDuration cost(const CostQuery& query) override {
    const WorkCounts work = scale_pixel_work(query.work, pixel_scale_);
    const brace_work_counts counts{work.rays,   work.samples, work.skip_steps, work.shading_fetches,
                                   work.texels, work.bytes};
    std::int64_t duration_ns = -1;
    const brace_result result = functions_.cost(self_, name_of(query.kind), &counts, &duration_ns);
    if (result != BRACE_OK || duration_ns < 0) {
      throw device_error(
          "{} failed in cost; expected BRACE_OK and 0 ns or more; found result {}, {} ns for {} job {}",
          name_, static_cast<int>(result), duration_ns, name_of(query.kind), query.index);
    }
    return scaled(SimDuration(duration_ns), scale_);
  }
  bool deterministic() const override { return true; }

 private:
  const brace_cost_functions& functions_;
  void* self_;
  std::string name_;
  double pixel_scale_;
  double scale_;
};

}  // namespace

WorkCounts scale_pixel_work(const WorkCounts& work, double pixel_scale) {
  if (pixel_scale == 1.0) return work;
  const auto times = [&](std::uint64_t count) {
    return static_cast<std::uint64_t>(std::llround(static_cast<double>(count) * pixel_scale));
  };
  return {.rays = times(work.rays),
          .samples = times(work.samples),
          .skip_steps = times(work.skip_steps),
          .shading_fetches = times(work.shading_fetches),
          .texels = times(work.texels),
          .bytes = work.bytes};
}

std::unique_ptr<CostSource> make_measured_cost(double scale) {
  return std::make_unique<MeasuredCost>(scale);
}

std::unique_ptr<CostSource> make_model_cost(const CostModel& model, double pixel_scale, double scale) {
  return std::make_unique<ModelCost>(model, pixel_scale, scale);
}

std::unique_ptr<CostSource> make_recorded_cost(const std::filesystem::path& run, double scale) {
  const bool is_directory = std::filesystem::is_directory(run);
  const std::filesystem::path file = is_directory ? run / "costs.csv" : run;
  return make_recorded_cost(read_costs_csv(file), file.string(), scale);
}

std::unique_ptr<CostSource> make_recorded_cost(std::vector<JobRecord> jobs, const std::string& name,
                                               double scale) {
  return std::make_unique<RecordedCost>(std::move(jobs), name, scale);
}

std::unique_ptr<CostSource> make_scripted_cost(const std::vector<CostSegment>& segments, double scale) {
  return std::make_unique<ScriptedCost>(segments, scale);
}

std::unique_ptr<CostSource> make_plugin_cost(const brace_cost_functions& functions, void* self,
                                             const std::string& name, double pixel_scale, double scale) {
  return std::make_unique<PluginCost>(functions, self, name, pixel_scale, scale);
}

}  // namespace brace
