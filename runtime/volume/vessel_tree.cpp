#include <cmath>
#include <cstdint>
#include <numbers>

#include "runtime/volume/row_generators.hpp"

namespace brace {
namespace {

using Vector = std::array<double, 3>;

constexpr std::uint64_t seed = 0x9e3779b97f4a7c15;
constexpr double trunk_length = 0.21;
constexpr double trunk_radius = 0.038;
constexpr double length_ratio = 0.84;
constexpr double radius_ratio = 0.794;  // Murray's law for two equal branches: 2^(-1/3)
constexpr int generations = 11;
constexpr double margin = 0.01;  // nothing reaches closer to the box than this

/// SplitMix64; the standard library's distributions differ between implementations.
class Random {
 public:
  double uniform(double low, double high) {
    std::uint64_t bits = (state_ += 0x9e3779b97f4a7c15);
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
    bits ^= bits >> 31;
    return low + (high - low) * static_cast<double>(bits >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = seed;
};

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector unit(const Vector& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

/// `direction` tilted by `angle_rad` towards `azimuth_rad` around it.
Vector tilted(const Vector& direction, double angle_rad, double azimuth_rad) {
  const Vector helper = std::abs(direction[0]) < 0.9 ? Vector{1, 0, 0} : Vector{0, 1, 0};
  const Vector u = unit(cross(direction, helper));
  const Vector v = cross(direction, u);
  Vector result{};
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = std::cos(angle_rad) * direction[i] +
                std::sin(angle_rad) * (std::cos(azimuth_rad) * u[i] + std::sin(azimuth_rad) * v[i]);
  return unit(result);
}

struct Branch {
  Vector start{}, direction{};
  double length = 0, radius = 0;
};

/// The end of a branch; its direction is mirrored in the walls that it would cross.
Vector end_inside(Branch& branch) {
  Vector end{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    end[axis] = branch.start[axis] + branch.length * branch.direction[axis];
    const double room = margin + branch.radius;
    if (end[axis] >= room && end[axis] <= 1 - room) continue;
    branch.direction[axis] = -branch.direction[axis];
    end[axis] = branch.start[axis] + branch.length * branch.direction[axis];
  }
  return end;
}

}  // namespace

std::vector<VesselSegment> vessel_tree() {
  using std::numbers::pi;
  Random random;
  std::vector<VesselSegment> tree;
  std::vector<Branch> tips{{{0.5, 0.5, 0.04}, {0, 0, 1}, trunk_length, trunk_radius}};
  for (int generation = 0; generation < generations; ++generation) {
    std::vector<Branch> next;
    for (Branch& branch : tips) {
      const Vector end = end_inside(branch);
      tree.push_back({branch.start, end, branch.radius, branch.radius * radius_ratio});
      const double azimuth_rad = random.uniform(0, 2 * pi);
      for (const double side : {0.0, pi}) {
        const double angle_rad = random.uniform(0.35, 0.85);
        next.push_back({end, tilted(branch.direction, angle_rad, azimuth_rad + side),
                        branch.length * length_ratio * random.uniform(0.8, 1.1),
                        branch.radius * radius_ratio});
      }
    }
    tips = std::move(next);
  }
  return tree;
}

}  // namespace brace
