#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tbb/task_group.h>

#include "runtime/frame/frame_work.hpp"
#include "runtime/metrics/frame_record.hpp"
#include "runtime/replay/gaze_source.hpp"
#include "runtime/replay/ideal_cache.hpp"
#include "runtime/replay/ideal_picture.hpp"

namespace brace {

/// Error of what the panels show against ideal pictures, some vsyncs at a time: each ideal picture is made
/// once, and comparisons are made by other threads while the caller goes on.
class ErrorMeter {
 public:
  /// Everything referred to must outlive it.
  struct Inputs {
    const gpu::Device& device;
    const Headset& headset;
    std::unique_ptr<IdealPicture> ideal;
    IdealCache& cache;
    /// Brings the session's scene, where that is the ideal picture's, too, to a version of its transfer
    /// function.
    std::function<void(std::int64_t version)> show_transfer;
    bool alone = false;  // all is done when add() returns: the caller measures times
  };
  explicit ErrorMeter(Inputs inputs);
  ~ErrorMeter() noexcept;  // which that of the tasks is not
  ErrorMeter(const ErrorMeter&) = delete;
  ErrorMeter& operator=(const ErrorMeter&) = delete;

  IdealPicture& ideal() { return *in_.ideal; }

  /// A vsync and what its panels show.
  void add(const ShowRequest& request, std::shared_ptr<const PanelPair> shown);

  struct VsyncErrors {
    std::int64_t vsync_index = 0;
    PanelErrors errors;
  };
  /// Measures what is still waiting.
  void finish();
  /// Of the vsyncs measured so far, in order.
  const std::vector<VsyncErrors>& errors() const { return errors_; }

  /// "" where every ideal picture was made for one vsync alone.
  std::string note() const;

 private:
  struct Waiting {
    ShowRequest request;
    std::shared_ptr<const PanelPair> shown, ideal;
    std::string key;
  };
  void measure();
  void find_ideals();
  void show_version(std::int64_t version);
  void compare();

  Inputs in_;
  std::size_t vsyncs_at_a_time_;
  std::array<std::vector<std::uint8_t>, 2> visible_;
  GazeWeights gaze_weights_;
  std::vector<Waiting> waiting_, compared_;  // the latter by the tasks
  std::vector<VsyncErrors> errors_, found_;  // found: by the tasks, of `compared_`
  std::int64_t made_ = 0, reused_ = 0;
  tbb::task_group tasks_;
};

}  // namespace brace
