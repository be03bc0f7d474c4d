#include "runtime/mab/level_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

template <class Demand>
LevelCoordinates coordinates_of_demand(const LevelMapInput& input, const Demand& demand) {
  std::vector<double> demands;
  demands.reserve(static_cast<std::size_t>(input.width_px) * static_cast<std::size_t>(input.height_px));
  for (int row = 0; row < input.height_px; ++row)
    for (int column = 0; column < input.width_px; ++column)
      demands.push_back(demand(tangents_of_pixel(input, column, row)));
  LevelCoordinates result;
  result.demand_min = input.demand_min;
  result.demand_max = std::max(*std::max_element(demands.begin(), demands.end()), 2.0 * input.demand_min);
  result.x.reserve(demands.size());
  for (const double d : demands)
    result.x.push_back(static_cast<float>(result.coordinate_of(d)));
  return result;
}

LevelCoordinates coordinates_of_radius(const LevelMapInput& input) {
  const glm::dvec2 size(input.width_px, input.height_px);
  const glm::dvec2 gaze = sim::tangents_to_target_uv(input.fov, input.gaze_tan) * size;
  const glm::dvec2 reach = glm::max(glm::abs(gaze), glm::abs(size - gaze));
  const double farthest = std::max(glm::length(reach), 1e-9);
  LevelCoordinates result;
  result.x.reserve(static_cast<std::size_t>(input.width_px) * static_cast<std::size_t>(input.height_px));
  for (int row = 0; row < input.height_px; ++row)
    for (int column = 0; column < input.width_px; ++column) {
      const double distance = glm::length(glm::dvec2(column + 0.5, row + 0.5) - gaze);
      result.x.push_back(static_cast<float>(std::min(distance / farthest, 1.0)));
    }
  return result;
}

}  // namespace

double LevelCoordinates::coordinate_of(double demand) const {
  if (!(demand > demand_min)) return 1.0;
  return std::clamp(std::log(demand_max / demand) / std::log(demand_max / demand_min), 0.0, 1.0);
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
