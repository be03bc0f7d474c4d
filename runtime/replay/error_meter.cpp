#include "runtime/replay/error_meter.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "runtime/metrics/image_error.hpp"

namespace brace {

namespace {

constexpr std::size_t kVsyncsAtATime = 8;

void append_pose(std::string& key, const Pose& pose) {
  const std::array<double, 7> numbers = {pose.position.x,    pose.position.y,    pose.position.z,
                                         pose.orientation.x, pose.orientation.y, pose.orientation.z,
                                         pose.orientation.w};
  key.append(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
}

std::string key_of(const IdealPicture& ideal, const ShowRequest& request) {
  std::string key = fmt::format("{}version {}\n", ideal.identity(), request.transfer_version);
  append_pose(key, request.true_world_from_head);
  if (request.true_scan) {
    append_pose(key, request.true_scan->first_line);
    append_pose(key, request.true_scan->last_line);
  }
  return key;
}

}  // namespace

ErrorMeter::ErrorMeter(Inputs inputs)
    : in_(std::move(inputs)),
      vsyncs_at_a_time_(in_.alone ? 1 : kVsyncsAtATime),
      visible_{visible_pixels(in_.headset, sim::Eye::left), visible_pixels(in_.headset, sim::Eye::right)},
      gaze_weights_(in_.headset) {}

ErrorMeter::~ErrorMeter() noexcept {
  tasks_.cancel();
  try {
    tasks_.wait();
  } catch (...) {  // of a run that has failed already
  }
}

void ErrorMeter::add(const ShowRequest& request, std::shared_ptr<const PanelPair> shown) {
  waiting_.push_back({request, std::move(shown), nullptr, key_of(*in_.ideal, request)});
  if (waiting_.size() >= vsyncs_at_a_time_) measure();
}

void ErrorMeter::finish() {
  measure();
  compare();
}

void ErrorMeter::measure() {
  find_ideals();
  compare();
}

void ErrorMeter::find_ideals() {
  const std::int64_t version_before = in_.ideal->scene().transfer_version;
  for (Waiting& one : waiting_)  // before new pictures drive out old ones
    one.ideal = in_.cache.find(one.key);
  for (Waiting& one : waiting_) {
    const auto same = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& other) {
      return other.ideal != nullptr && other.key == one.key;
    });
    if (same != waiting_.end()) {
      one.ideal = same->ideal;
      ++reused_;
      continue;
    }
    show_version(one.request.transfer_version);
    one.ideal = std::make_shared<const PanelPair>(
        in_.ideal->show({one.request.true_world_from_head, one.request.true_scan}));
    in_.cache.keep(one.key, one.ideal);
    ++made_;
  }
  if (!in_.ideal->has_own_scene()) show_version(version_before);  // what is cast next still shows it
}

void ErrorMeter::show_version(std::int64_t version) {
  if (in_.ideal->scene().transfer_version == version) return;
  if (!in_.ideal->has_own_scene()) {
    in_.show_transfer(version);
    return;
  }
  in_.ideal->scene().show_transfer(in_.device, version);
  in_.ideal->transfer_changed();
}

/// Takes the figures of the comparisons before, and has the waiting ones made.
void ErrorMeter::compare() {
  tasks_.wait();
  errors_.insert(errors_.end(), found_.begin(), found_.end());
  compared_ = std::exchange(waiting_, {});
  found_.assign(compared_.size(), {});
  for (std::size_t i = 0; i < compared_.size(); ++i) {
    found_[i].vsync_index = compared_[i].request.vsync_index;
    const auto measure_dssim = [this, i](std::size_t eye, double PanelErrors::*dssim) {
      const Waiting& one = compared_[i];
      found_[i].errors.*dssim = dssim_from_ssim(ssim((*one.shown)[eye], (*one.ideal)[eye], visible_[eye]));
    };
    tasks_.run([=] { measure_dssim(0, &PanelErrors::dssim_left); });
    tasks_.run([=] { measure_dssim(1, &PanelErrors::dssim_right); });
  }
  // One after the other: an eye's weights are kept from gaze to gaze.
  const auto measure_weighted = [this](sim::Eye which, double PanelErrors::*rmse) {
    const auto eye = static_cast<std::size_t>(which);
    for (std::size_t i = 0; i < compared_.size(); ++i) {
      const Waiting& one = compared_[i];
      found_[i].errors.*rmse =
          weighted_rmse((*one.shown)[eye], (*one.ideal)[eye], gaze_weights_.of(which, one.request.true_gaze));
    }
  };
  tasks_.run([=] { measure_weighted(sim::Eye::left, &PanelErrors::weighted_rmse_left); });
  tasks_.run([=] { measure_weighted(sim::Eye::right, &PanelErrors::weighted_rmse_right); });
  if (in_.alone) tasks_.wait();
}

std::string ErrorMeter::note() const {
  if (reused_ == 0) return "";
  return fmt::format("{} cast, {} again as for an earlier vsync or run", made_, reused_);
}

}  // namespace brace
