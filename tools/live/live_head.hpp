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

  Pose at(SimTime time) const;
  /// Any motion by hand takes the head over; 'T' gives it back to the trace.
  void steer(const LiveWindow& window, SimTime time, double seconds);
  bool by_hand() const { return by_hand_; }

 private:
  sim::PoseTrace trace_;
  SimTime start_;
  HeadControl control_;
  bool by_hand_ = false;
};

/// Records while asked to, and writes a trace when that ends.
class Recorder {
 public:
  explicit Recorder(std::filesystem::path file);
  void toggle();
  void add(SimTime time, const Pose& pose) {
    if (on_) poses_.add(time, pose);
  }
  bool on() const { return on_; }
  void write();

 private:
  std::filesystem::path file_;
  bool on_;
  HeadRecording poses_;
};

}  // namespace brace
