#pragma once

#include <filesystem>

#include "runtime/replay/headset.hpp"
#include "tools/live/head_control.hpp"
#include "tools/live/window.hpp"

namespace brace {

/// Where the head is: on the session's trace, over and over, or where mouse and keys have put it.
class LiveHead {
 public:
  LiveHead(const Session& session, const std::filesystem::path& data_folder);

  /// By hand, no later than it was last steered, it went evenly from where it was the time before.
  Pose at(SimTime time) const;
  /// Any motion by hand takes the head over; 'T' gives it back to the trace.
  void steer(const LiveWindow& window, SimTime time, double seconds);
  bool by_hand() const { return by_hand_; }

 private:
  sim::PoseTrace trace_;
  SimTime start_;
  HeadControl control_;
  bool by_hand_ = false;
  sim::TimedPose before_{};  // where it was when steer() was called before
  SimTime steered_{};
};

/// Records while asked to, and writes a trace when that ends.
class Recorder {
 public:
  Recorder(std::filesystem::path file, std::string session);
  void toggle();
  void add(SimTime time, const LiveHead& head) {
    if (on_) poses_.go_on_to(time, [&](SimTime at) { return head.at(at); });
  }
  bool on() const { return on_; }
  void write();

 private:
  std::filesystem::path file_;
  std::string session_;
  bool on_;
  HeadRecording poses_;
};

}  // namespace brace
