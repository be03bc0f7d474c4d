#include "runtime/volume/row_generators.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace brace {
namespace {

using std::numbers::pi;

// Marschner and Lobb 1994: f_M = 6, alpha = 0.25, on [-1, 1]^3.
constexpr double ml_frequency = 6;
constexpr double ml_alpha = 0.25;
constexpr double ml_norm = 1 / (2 * (1 + ml_alpha));

double ml_axial(double z) {
  return (1 - std::sin(pi * (2 * z - 1) / 2)) * ml_norm;
}

double ml_radial(double x, double y) {
  const double radius = std::hypot(2 * x - 1, 2 * y - 1);
  return ml_alpha * (1 + std::cos(2 * pi * ml_frequency * std::cos(pi * radius / 2))) * ml_norm;
}

bool in_middle_half(double t) {
  return t >= 0.25 && t <= 0.75;
}

struct Shell {
  double radius, height;
};
constexpr std::array<Shell, 4> shells{{{0.12, 1.0}, {0.21, 0.75}, {0.30, 0.5}, {0.39, 0.25}}};
constexpr double shell_half_width = 0.03;  // shells do not overlap

/// A bump h (1 - u^2)^2 with u the distance from the shell in half widths: continuous with its derivative.
double shell_profile(double radius) {
  for (const Shell& shell : shells) {
    const double u = (radius - shell.radius) / shell_half_width;
    if (std::abs(u) < 1) return shell.height * (1 - u * u) * (1 - u * u);
  }
  return 0;
}

double centre_of(int index, int dim) {
  return (index + 0.5) / dim;
}

class MarschnerLobbRows : public RowGenerator {
 public:
  explicit MarschnerLobbRows(std::array<int, 3> dims) : dims_(dims) {
    const std::size_t width = static_cast<std::size_t>(dims[0]);
    radial_.resize(width * static_cast<std::size_t>(dims[1]));
    for (std::size_t i = 0; i < radial_.size(); ++i)
      radial_[i] = ml_radial(centre_of(static_cast<int>(i % width), dims[0]),
                             centre_of(static_cast<int>(i / width), dims[1]));
  }
  void start_slice(int z) override { axial_ = ml_axial(centre_of(z, dims_[2])); }
  void row(int y, std::span<double> out) override {
    const double* radial = radial_.data() + static_cast<std::size_t>(y) * out.size();
    for (std::size_t x = 0; x < out.size(); ++x)
      out[x] = axial_ + radial[x];
  }

 private:
  std::array<int, 3> dims_;
  std::vector<double> radial_;  // one slice
  double axial_ = 0;
};

class BoxRows : public RowGenerator {
 public:
  explicit BoxRows(std::array<int, 3> dims) : dims_(dims) {}
  void start_slice(int z) override { z_inside_ = in_middle_half(centre_of(z, dims_[2])); }
  void row(int y, std::span<double> out) override {
    const bool inside = z_inside_ && in_middle_half(centre_of(y, dims_[1]));
    for (std::size_t x = 0; x < out.size(); ++x)
      out[x] = inside && in_middle_half(centre_of(static_cast<int>(x), dims_[0])) ? 1.0 : 0.0;
  }

 private:
  std::array<int, 3> dims_;
  bool z_inside_ = false;
};

class ShellRows : public RowGenerator {
 public:
  explicit ShellRows(std::array<int, 3> dims) : dims_(dims) {}
  void start_slice(int z) override { z_ = centre_of(z, dims_[2]) - 0.5; }
  void row(int y, std::span<double> out) override {
    const double dy = centre_of(y, dims_[1]) - 0.5;
    const double outside = dy * dy + z_ * z_;
    constexpr double reach = shells.back().radius + shell_half_width;
    for (std::size_t x = 0; x < out.size(); ++x) {
      const double dx = centre_of(static_cast<int>(x), dims_[0]) - 0.5;
      const double squared = dx * dx + outside;
      out[x] = squared < reach * reach ? shell_profile(std::sqrt(squared)) : 0.0;
    }
  }

 private:
  std::array<int, 3> dims_;
  double z_ = 0;
};

class SlabRows : public RowGenerator {
 public:
  void start_slice(int) override {}
  void row(int, std::span<double> out) override { std::ranges::fill(out, 1.0); }
};

double vessel_value(const VesselSegment& s, double x, double y, double z) {
  const std::array<double, 3> axis{s.b[0] - s.a[0], s.b[1] - s.a[1], s.b[2] - s.a[2]};
  const std::array<double, 3> to{x - s.a[0], y - s.a[1], z - s.a[2]};
  const double along = to[0] * axis[0] + to[1] * axis[1] + to[2] * axis[2];
  const double t = std::clamp(along / (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]), 0.0, 1.0);
  double squared = 0;
  for (std::size_t i = 0; i < 3; ++i)
    squared += (to[i] - t * axis[i]) * (to[i] - t * axis[i]);
  const double radius = s.radius_a + t * (s.radius_b - s.radius_a);
  return std::max(0.0, 1 - squared / (radius * radius));
}

/// The indices whose voxel centres may lie in [low, high].
std::pair<int, int> index_range(double low, double high, int dim) {
  const int first = static_cast<int>(std::floor(low * dim - 0.5));
  const int last = static_cast<int>(std::ceil(high * dim - 0.5));
  return {std::max(first, 0), std::min(last, dim - 1)};
}

class VesselRows : public RowGenerator {
 public:
  explicit VesselRows(std::array<int, 3> dims) : dims_(dims), tree_(vessel_tree()) {
    for (const VesselSegment& segment : tree_) {
      Reach& reach = reaches_.emplace_back();
      const double radius = std::max(segment.radius_a, segment.radius_b);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax(segment.a[axis], segment.b[axis]);
        reach.indices[axis] = index_range(low - radius, high + radius, dims[axis]);
      }
    }
  }

  void start_slice(int z) override {
    z_ = z;
    active_.clear();
    for (std::size_t i = 0; i < tree_.size(); ++i)
      if (reaches_[i].holds(2, z)) active_.push_back(i);
  }

  void row(int y, std::span<double> out) override {
    std::ranges::fill(out, 0.0);
    const double cy = centre_of(y, dims_[1]);
    const double cz = centre_of(z_, dims_[2]);
    for (const std::size_t i : active_) {
      if (!reaches_[i].holds(1, y)) continue;
      const auto [first, last] = reaches_[i].indices[0];
      for (int x = first; x <= last; ++x) {
        double& value = out[static_cast<std::size_t>(x)];
        value = std::max(value, vessel_value(tree_[i], centre_of(x, dims_[0]), cy, cz));
      }
    }
  }

 private:
  struct Reach {
    std::array<std::pair<int, int>, 3> indices;
    bool holds(std::size_t axis, int index) const {
      return index >= indices[axis].first && index <= indices[axis].second;
    }
  };

  std::array<int, 3> dims_;
  std::vector<VesselSegment> tree_;
  std::vector<Reach> reaches_;
  std::vector<std::size_t> active_;
  int z_ = 0;
};

}  // namespace

double marschner_lobb(double x, double y, double z) {
  return ml_axial(z) + ml_radial(x, y);
}

double solid_box(double x, double y, double z) {
  return in_middle_half(x) && in_middle_half(y) && in_middle_half(z) ? 1.0 : 0.0;
}

double nested_shells(double x, double y, double z) {
  const double dx = x - 0.5, dy = y - 0.5, dz = z - 0.5;
  return shell_profile(std::sqrt(dx * dx + (dy * dy + dz * dz)));
}

double vessels(std::span<const VesselSegment> tree, double x, double y, double z) {
  double value = 0;
  for (const VesselSegment& segment : tree)
    value = std::max(value, vessel_value(segment, x, y, z));
  return value;
}

std::unique_ptr<RowGenerator> make_row_generator(const GeneratorSpec& spec) {
  if (spec.name == "marschner_lobb") return std::make_unique<MarschnerLobbRows>(spec.dims);
  if (spec.name == "solid_box") return std::make_unique<BoxRows>(spec.dims);
  if (spec.name == "nested_shells") return std::make_unique<ShellRows>(spec.dims);
  if (spec.name == "fractal_vessels") return std::make_unique<VesselRows>(spec.dims);
  if (spec.name == "slab") return std::make_unique<SlabRows>();
  return nullptr;
}

}  // namespace brace
