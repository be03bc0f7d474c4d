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

/// How much less what is farthest from the gaze point counts: enough to tell equal demands apart.
constexpr double tilt = 0.01;

/// Hands the radial map's coordinates out in the order of the demands.
void match_radii(LevelCoordinates& map, const std::vector<double>& demands, std::vector<float> radii) {
  struct Pixel {
    double demand;
    std::uint32_t index;
  };
  std::vector<Pixel> pixels;
  pixels.reserve(demands.size());
  for (const double demand : demands)
    pixels.push_back({demand, static_cast<std::uint32_t>(pixels.size())});
  std::sort(pixels.begin(), pixels.end(), [](const Pixel& a, const Pixel& b) {
    return a.demand != b.demand ? a.demand > b.demand : a.index < b.index;
  });
  std::sort(radii.begin(), radii.end());
  map.x.assign(demands.size(), 1.0f);
  map.demand_of_rank.reserve(demands.size());
  for (std::size_t rank = 0; rank < pixels.size(); ++rank) {
    const Pixel& pixel = pixels[rank];
    map.demand_of_rank.push_back(pixel.demand);
    if (pixel.demand > map.demand_min) map.x[pixel.index] = radii[rank];
  }
  map.x_of_rank = std::move(radii);
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
  match_radii(result, demands, std::move(radii));
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
  const auto behind = std::partition_point(demand_of_rank.begin(), demand_of_rank.end(),
                                           [&](double larger) { return larger > demand; });
  const auto larger = static_cast<std::size_t>(behind - demand_of_rank.begin());
  return larger == 0 ? 0.0 : static_cast<double>(x_of_rank[larger - 1]);
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
