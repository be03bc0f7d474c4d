#include "runtime/replay/recorded_work.hpp"

#include <algorithm>

#include "runtime/timeline/costs_csv.hpp"

namespace brace {

RecordedWork::RecordedWork(const std::filesystem::path& run) {
  std::vector<JobRecord> jobs = read_costs_csv(std::filesystem::is_directory(run) ? run / "costs.csv" : run);
  std::stable_sort(jobs.begin(), jobs.end(),
                   [](const JobRecord& a, const JobRecord& b) { return a.index < b.index; });
  for (const JobRecord& job : jobs)
    work_[static_cast<std::size_t>(job.kind)].push_back(job.work);
}

JobOutcome RecordedWork::next(JobKind kind) {
  const auto k = static_cast<std::size_t>(kind);
  const std::size_t n = done_[k]++;
  return n < work_[k].size() ? JobOutcome{work_[k][n]} : JobOutcome{};
}

}  // namespace brace
