#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "runtime/gpu/measurements.hpp"
#include "runtime/report/report_input.hpp"
#include "runtime/session/session.hpp"

namespace brace {

struct ReplayOptions {
  std::filesystem::path data_folder;    // share/brace
  std::string gpu{};                    // the value of --gpu
  std::string version{};                // of Brace
  PipelineStage no_warp{};              // warp/none: what ideal pictures are shown with
  PipelineStage full_rate{};            // rays/full_rate: what they are rendered with
  std::function<bool()> interrupted{};  // asked often; once true, the replay ends with Interrupted
  int probes = 64;                      // most eye frames rendered to count work where no pictures are made
  bool messages = true;                 // on stderr: what auto chose, memory
  /// What was measured of the device; null: every scene looks into the default folder anew.
  std::shared_ptr<gpu::Measurements> measurements{};
};

/// The user asked the replay to end.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

inline void throw_if_interrupted(const ReplayOptions& options) {
  if (options.interrupted && options.interrupted()) throw Interrupted();
}

/// A session of a run; a comparison has several, with different labels.
struct LabelledSession {
  std::string label;
  Session session;
  std::vector<LeftOut> left_out{};  // by the planner, for the report
};

struct ReplayOutcome {
  std::string summary_json;
  std::string failure;  // "" or what ended the run early; the run directory then says that it is incomplete
};

/// Replays the sessions and writes one run directory for all of them; the first one is the run's own. A stage
/// or device that fails after vsyncs have been shown ends the run there. Throws brace::Error or Interrupted;
/// then there is no run directory.
ReplayOutcome replay(const std::vector<LabelledSession>& sessions, const ReplayOptions& options,
                     const std::filesystem::path& destination);

}  // namespace brace
