#include "runtime/gpu/measurements.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <ctime>
#include <fstream>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "runtime/gpu/glsl_source.hpp"
#include "runtime/gpu/shader_compiler.hpp"

namespace brace::gpu {
namespace {

using Json = nlohmann::ordered_json;

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 16> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d", &utc)};
}

/// What a measurement depends on; the file repeats it, for people and against mix-ups.
Json circumstances(const DeviceInfo& device, const Comparison& wanted) {
  return {{"what", wanted.what},
          {"device", device.name},
          {"uuid", device.uuid},
          {"driver", device.driver},
          {"kernels", wanted.kernels}};
}

std::string measurement_key(const Json& conditions) {
  KernelDescription text;
  text.main = {"measurement 1", conditions.dump()};
  return content_key(text, {}, "");
}

bool are_times(const std::vector<double>& times_ms, std::size_t count) {
  return times_ms.size() == count && std::all_of(times_ms.begin(), times_ms.end(), [](double time_ms) {
           return std::isfinite(time_ms) && time_ms > 0.0;
         });
}

std::optional<Measurement> read_measurement(const std::filesystem::path& path, const Json& conditions,
                                            const Comparison& wanted) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) return std::nullopt;
  std::ifstream file(path);
  const Json json = file ? Json::parse(file, nullptr, false) : Json();
  if (!json.is_object()) return std::nullopt;
  for (const auto& [name, value] : conditions.items())
    if (!json.contains(name) || json[name] != value) return std::nullopt;
  if (!json.contains("times_ms") || !json["times_ms"].is_object() || !json.contains("measured") ||
      !json["measured"].is_string())
    return std::nullopt;
  Measurement found;
  found.day = json["measured"].get<std::string>();
  found.from_cache = true;
  for (const std::string& rival : wanted.rivals) {
    const auto time = json["times_ms"].find(rival);
    if (time == json["times_ms"].end() || !time->is_number()) return std::nullopt;
    found.times_ms.push_back(time->get<double>());
  }
  if (!are_times(found.times_ms, wanted.rivals.size())) return std::nullopt;
  return found;
}

/// "" or why not.
std::string write_measurement(const std::filesystem::path& path, Json json, const Comparison& wanted,
                              const Measurement& measured) {
  static std::atomic<unsigned> counter{0};
  for (std::size_t i = 0; i < wanted.rivals.size(); ++i)
    json["times_ms"][wanted.rivals[i]] = measured.times_ms[i];
  json["measured"] = measured.day;
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  const std::filesystem::path aside = fmt::format("{}.{}.{}.tmp", path.string(), getpid(), counter++);
  std::ofstream file(aside, std::ios::trunc);
  file << json.dump(2) << '\n';
  file.close();
  const bool written = !file.fail();
  if (written) std::filesystem::rename(aside, path, error);
  if (written && !error) return "";
  std::error_code ignored;
  std::filesystem::remove(aside, ignored);
  return path.parent_path().string() + " cannot be written";
}

}  // namespace

std::filesystem::path default_measurement_folder() {
  const std::filesystem::path spirv = default_cache_folder();
  return spirv.empty() ? spirv : spirv.parent_path() / "measured";
}

std::string Measurement::origin() const {
  if (from_cache) return fmt::format("measured {}, cached", day);
  return not_kept.empty() ? fmt::format("measured {}", day)
                          : fmt::format("measured {}; not kept: {}", day, not_kept);
}

const Measurement& Measurements::get(const DeviceInfo& device, const Comparison& wanted,
                                     const std::function<std::vector<double>()>& measure) {
  const Json conditions = circumstances(device, wanted);
  const std::string key = measurement_key(conditions);
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const std::filesystem::path path = folder_ / (key + ".json");
  if (!folder_.empty() && use_ == Use::kept)
    if (std::optional<Measurement> kept = read_measurement(path, conditions, wanted))
      return known_.emplace(key, std::move(*kept)).first->second;
  Measurement measured;
  for (const double time_ms : measure())
    measured.times_ms.push_back(std::round(time_ms * 1e6) /
                                1e6);  // nanoseconds: the same here and in the file
  measured.day = today();
  if (!are_times(measured.times_ms, wanted.rivals.size()))
    throw device_error("{}: {} gives no times that can be compared", wanted.what, device.name);
  ++taken_;
  measured.not_kept = folder_.empty() ? "neither XDG_CACHE_HOME nor HOME is set"
                                      : write_measurement(path, conditions, wanted, measured);
  return known_.emplace(key, std::move(measured)).first->second;
}

}  // namespace brace::gpu
