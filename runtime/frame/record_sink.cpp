#include "runtime/frame/record_sink.hpp"

#include <algorithm>

namespace brace {

std::vector<JobRecord> RunRecords::jobs_by_submission() const {
  std::vector<JobRecord> sorted = jobs_;
  std::sort(sorted.begin(), sorted.end(),
            [](const JobRecord& a, const JobRecord& b) { return a.job < b.job; });
  return sorted;
}

}  // namespace brace
