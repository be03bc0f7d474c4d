#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "runtime/gpu/device.hpp"

namespace brace::gpu {

/// $XDG_CACHE_HOME/brace/measured, else ~/.cache/brace/measured; "" when neither is set.
std::filesystem::path default_measurement_folder();

/// Times of rivals on one device and driver. A measurement is as good as these and the kernels' text.
struct Comparison {
  std::string what;                 // "volume path, 8-bit voxels"
  std::string kernels;              // kernel_key of what is timed
  std::vector<std::string> rivals;  // at least one
};

struct Measurement {
  std::vector<double> times_ms;  // of the rivals, all > 0
  std::string day;               // when: "2026-11-29"
  bool from_cache = false;       // taken by an earlier process
  std::string not_kept;          // "" or why the next process will measure again

  /// "measured 2026-11-29, cached", "measured just now; not kept: …".
  std::string origin() const;
};

/// Measurements that are kept in a folder of small JSON files, and for the life of this object. Entries
/// appear whole, so any number of processes share the folder; what is damaged reads as absent, and where
/// nothing can be written nothing is kept. One thread at a time.
class Measurements {
 public:
  enum class Use { kept, anew };  // anew: what the folder has is not read, but replaced

  explicit Measurements(std::filesystem::path folder = default_measurement_folder(), Use use = Use::kept)
      : folder_(std::move(folder)), use_(use) {}

  /// The measurement if it is known, else that which `measure` takes: a time in milliseconds per rival.
  /// Throws what `measure` throws, and device_error when a time is not a positive number.
  const Measurement& get(const DeviceInfo& device, const Comparison& wanted,
                         const std::function<std::vector<double>()>& measure);

  /// How many were measured here instead of found.
  int taken() const { return taken_; }

 private:
  std::filesystem::path folder_;
  Use use_;
  std::map<std::string, Measurement> known_;  // by key
  int taken_ = 0;
};

}  // namespace brace::gpu
