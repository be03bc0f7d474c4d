#include "runtime/mab/level_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "base/error.hpp"

namespace brace {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double foveal_resolution_rad = pi / 180.0 / 48.0;

/// Densest direction of d(display radius) / d(source radius) over the source radius, for one channel.
class RadialDensity {
 public:
  RadialDensity(const sim::EyeLens& lens, sim::Channel channel)
      : usable_(sim::usable_radius(lens, channel)),
        end_(sim::lens_forward(lens.kind, k_of(lens, channel), usable_)) {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const double source = end_ * static_cast<double>(i) / static_cast<double>(table_.size() - 1);
      table_[i] = density(lens, channel, source);
    }
  }

  /// 0 beyond the usable radius.
  double at(double source_radius) const {
    if (!(source_radius <= end_)) return 0.0;
    const double place = end_ > 0.0 ? source_radius / end_ * static_cast<double>(table_.size() - 1) : 0.0;
    const auto entry = std::min(static_cast<std::size_t>(place), table_.size() - 2);
    // Never less than it is: the larger of two neighbours.
    return std::max(table_[entry], table_[entry + 1]);
  }

 private:
  static const std::array<double, 5>& k_of(const sim::EyeLens& lens, sim::Channel channel) {
    return lens.rgb[static_cast<std::size_t>(channel)].k;
  }

  double density(const sim::EyeLens& lens, sim::Channel channel, double source) const {
    const std::array<double, 5>& k = k_of(lens, channel);
    const double p = sim::lens_inverse(lens.kind, k, source, usable_).value_or(usable_);
    const double scale = sim::lens_scale(lens.kind, k, p);
    const double radial = scale + p * sim::lens_scale_derivative(lens.kind, k, p);
    const double flattest = std::min(radial, scale);
    return flattest > 1e-6 ? 1.0 / flattest : 1e6;
  }

  double usable_, end_;
  std::array<double, 1024> table_{};
};

/// The lens' part of the demand for a whole picture.
class LensDemand {
 public:
  explicit LensDemand(const LevelMapInput& input)
      : tan_per_unit_(input.lens.tan_per_unit),
        density_{RadialDensity(input.lens, sim::Channel::red), RadialDensity(input.lens, sim::Channel::green),
                 RadialDensity(input.lens, sim::Channel::blue)} {
    const glm::dvec2 panel_px_per_unit =
        glm::dvec2(input.panel_width_px, input.panel_height_px) / input.lens.panel_size_units;
    const glm::dvec2 picture_px_per_unit =
        glm::dvec2(input.width_px / input.fov.width(), input.height_px / input.fov.height()) * tan_per_unit_;
    const glm::dvec2 ratio = panel_px_per_unit / picture_px_per_unit;
    panel_per_picture_ = std::max(ratio.x, ratio.y);
  }

  double at(glm::dvec2 t) const {
    const double radius = glm::length(t / tan_per_unit_);
    double densest = 0.0;
    for (const RadialDensity& channel : density_)
      densest = std::max(densest, channel.at(radius));
    return densest * panel_per_picture_;
  }

 private:
  glm::dvec2 tan_per_unit_;
  std::array<RadialDensity, 3> density_;
  double panel_per_picture_ = 1.0;
};

glm::dvec2 tangents_of_pixel(const LevelMapInput& input, int x, int y) {
  return sim::target_uv_to_tangents(input.fov, {(x + 0.5) / input.width_px, (y + 0.5) / input.height_px});
}

/// Distances of pixels from a point, over that of the farthest corner from another.
class Distances {
 public:
  Distances(const LevelMapInput& input, glm::dvec2 from_tan, glm::dvec2 reach_tan)
      : from_(place(input, from_tan)) {
    const glm::dvec2 size(input.width_px, input.height_px), middle = place(input, reach_tan);
    const glm::dvec2 reach = glm::max(glm::abs(middle), glm::abs(size - middle));
    farthest_ = std::max(glm::length(reach), 1e-9);
  }
  /// 1 beyond.
  double of_pixel(int x, int y) const {
    return std::min(glm::distance(glm::dvec2(x + 0.5, y + 0.5), from_) / farthest_, 1.0);
  }

 private:
  static glm::dvec2 place(const LevelMapInput& input, glm::dvec2 tan) {
    return sim::tangents_to_target_uv(input.fov, tan) * glm::dvec2(input.width_px, input.height_px);
  }
  glm::dvec2 from_;
  double farthest_ = 1.0;
};

constexpr std::size_t demand_bins = 1 << 16;
/// How much less what is farthest from the gaze point counts: enough to tell equal demands apart.
constexpr double tilt = 0.01;

/// Place of a demand on a logarithmic scale from demand_max to demand_min, 0 to 1.
double log_place(const LevelCoordinates& map, double demand) {
  if (!(demand > map.demand_min)) return 1.0;
  return std::clamp(std::log(map.demand_max / demand) / std::log(map.demand_max / map.demand_min), 0.0, 1.0);
}

/// `radii`: of all pixels, in any order.
void match_radii(LevelCoordinates& map, const std::vector<double>& demands, std::vector<float> radii) {
  std::vector<std::uint32_t> bins(demand_bins, 0);
  for (const double demand : demands) {
    const double place = log_place(map, demand) * static_cast<double>(demand_bins);
    ++bins[std::min(static_cast<std::size_t>(place), demand_bins - 1)];
  }
  std::sort(radii.begin(), radii.end());
  map.x_of_place.assign(demand_bins + 1, 0.0);
  std::size_t above = 0;
  for (std::size_t i = 0; i < demand_bins; ++i) {
    above += bins[i];
    if (above > 0) map.x_of_place[i + 1] = static_cast<double>(radii[above - 1]);
  }
}

template <class Demand>
LevelCoordinates coordinates_of_demand(const LevelMapInput& input, const Demand& demand) {
  const Distances distances(input, input.gaze_tan, input.reach_tan.value_or(input.gaze_tan));
  std::vector<double> demands;
  std::vector<float> radii;
  demands.reserve(static_cast<std::size_t>(input.width_px) * static_cast<std::size_t>(input.height_px));
  radii.reserve(demands.capacity());
  for (int row = 0; row < input.height_px; ++row)
    for (int column = 0; column < input.width_px; ++column) {
      const double off = distances.of_pixel(column, row);
      const double useful = std::min(demand(tangents_of_pixel(input, column, row)), input.demand_cap);
      demands.push_back(useful * (1.0 - tilt * off * off));
      radii.push_back(static_cast<float>(off));
    }
  LevelCoordinates result;
  result.demand_min = input.demand_min;
  result.demand_max = std::max(*std::max_element(demands.begin(), demands.end()), 2.0 * input.demand_min);
  match_radii(result, demands, std::move(radii));
  result.x.reserve(demands.size());
  for (const double d : demands)
    result.x.push_back(static_cast<float>(result.coordinate_of(d)));
  return result;
}

LevelCoordinates coordinates_of_radius(const LevelMapInput& input) {
  const Distances distances(input, input.gaze_tan, input.reach_tan.value_or(input.gaze_tan));
  LevelCoordinates result;
  result.x.reserve(static_cast<std::size_t>(input.width_px) * static_cast<std::size_t>(input.height_px));
  for (int row = 0; row < input.height_px; ++row)
    for (int column = 0; column < input.width_px; ++column)
      result.x.push_back(static_cast<float>(distances.of_pixel(column, row)));
  return result;
}

}  // namespace

double LevelCoordinates::coordinate_of(double demand) const {
  if (!(demand > demand_min)) return 1.0;
  const double place = log_place(*this, demand) * static_cast<double>(x_of_place.size() - 1);
  const std::size_t bin = std::min(static_cast<std::size_t>(place), x_of_place.size() - 2);
  const double t = place - static_cast<double>(bin);
  return std::min(x_of_place[bin] + t * (x_of_place[bin + 1] - x_of_place[bin]), 1.0);
}

double lens_demand(const LevelMapInput& input, glm::dvec2 t) {
  return LensDemand(input).at(t);
}

double acuity_demand(const LevelMapInput& input, glm::dvec2 t) {
  const glm::dvec3 looked_at = glm::normalize(glm::dvec3(t, -1.0));
  const glm::dvec3 gaze = glm::normalize(glm::dvec3(input.gaze_tan, -1.0));
  const double eccentricity_rad =
      std::atan2(glm::length(glm::cross(looked_at, gaze)), glm::dot(looked_at, gaze));
  const double pitch_tan =
      std::max(input.fov.width() / input.width_px, input.fov.height() / input.height_px) *
      input.resolution_scale;
  const double pitch_rad = pitch_tan / std::sqrt(1.0 + glm::dot(t, t));
  return pitch_rad / (foveal_resolution_rad + input.acuity_slope * eccentricity_rad);
}

LevelCoordinates level_coordinates(LevelMap map, const LevelMapInput& input) {
  BRACE_CHECK(input.width_px > 0 && input.height_px > 0);
  if (map == LevelMap::radius) return coordinates_of_radius(input);
  const auto acuity = [&](glm::dvec2 t) { return acuity_demand(input, t); };
  if (map == LevelMap::eccentricity) return coordinates_of_demand(input, acuity);
  const LensDemand lens(input);
  if (map == LevelMap::lens) return coordinates_of_demand(input, [&](glm::dvec2 t) { return lens.at(t); });
  return coordinates_of_demand(input, [&](glm::dvec2 t) { return lens.at(t) * acuity(t); });
}

}  // namespace brace
