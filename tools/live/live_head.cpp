#include "tools/live/live_head.hpp"

#include <fmt/core.h>

#include "hmd_sim/trace_io.hpp"

namespace brace {

namespace {

Pose between(const sim::TimedPose& from, const sim::TimedPose& to, SimTime time) {
  if (time <= from.time) return from.world_from_head;
  const double share = to_s(time - from.time) / to_s(to.time - from.time);
  const Pose &a = from.world_from_head, &b = to.world_from_head;
  return {glm::slerp(a.orientation, b.orientation, share), glm::mix(a.position, b.position, share)};
}

}  // namespace

LiveHead::LiveHead(const Session& session, const std::filesystem::path& data_folder)
    : trace_(load_head_trace(session.trace, data_folder).trace),
      start_(trace_.begin_time() + from_s(session.trace.start_s)) {
  if (start_ >= trace_.end_time()) start_ = trace_.begin_time();
}

Pose LiveHead::at(SimTime time) const {
  if (by_hand_)
    return time >= steered_ ? control_.pose() : between(before_, {steered_, control_.pose()}, time);
  const SimDuration length = trace_.end_time() - start_;
  const SimDuration in = length > SimDuration(0) ? time.time_since_epoch() % length : SimDuration(0);
  return trace_.at(start_ + in, sim::Interpolation::hermite);
}

void LiveHead::steer(const LiveWindow& window, SimTime time, double seconds) {
  const HeadInput& input = window.head();
  const bool moved = input.turn_right_rad != 0 || input.turn_up_rad != 0 || input.right != 0 ||
                     input.up != 0 || input.forward != 0;
  before_ = {steered_, at(steered_)};
  if (moved && !by_hand_) {
    control_.start_from(at(time));
    by_hand_ = true;
  }
  if (by_hand_) control_.advance(input, seconds);
  if (window.pressed('T')) by_hand_ = false;
  steered_ = time;
}

Recorder::Recorder(std::filesystem::path file, std::string session)
    : file_(std::move(file)), session_(std::move(session)), on_(!file_.empty()) {
  if (file_.empty()) file_ = "live.trace";
}

void Recorder::toggle() {
  if (on_) write();
  on_ = !on_;
}

void Recorder::write() {
  if (on_ && poses_.can_be_a_trace()) {
    const std::string origin =
        fmt::format("recorded by brace live in session {}, from {:.9f} s of its run on", session_,
                    to_s(poses_.begin() - SimTime()));
    sim::write_trace(file_, poses_.trace(), sim::TraceFormat::brace, {origin});
    fmt::print(stderr, "live: {} poses in {}\n", poses_.size(), file_.string());
  }
  poses_ = {};
}

}  // namespace brace
