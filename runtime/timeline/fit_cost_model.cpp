#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "base/error.hpp"
#include "runtime/timeline/cost_model.hpp"

namespace brace {

namespace {

constexpr int column_count = 9;  // bases of cast, warp, update; then the items
constexpr std::array<const char*, column_count> column_names{
    "base_ns.cast",      "base_ns.warp",          "base_ns.update", "item_ns.ray", "item_ns.sample",
    "item_ns.skip_step", "item_ns.shading_fetch", "item_ns.texel",  "item_ns.byte"};

Eigen::RowVectorXd counts_row(const CostSample& sample) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(column_count);
  row[static_cast<int>(sample.kind)] = 1.0;
  const WorkCounts& work = sample.work;
  const std::array<std::uint64_t, 6> items{work.rays,   work.samples, work.skip_steps, work.shading_fetches,
                                           work.texels, work.bytes};
  for (int i = 0; i < 6; ++i)
    row[3 + i] = static_cast<double>(items[static_cast<std::size_t>(i)]);
  return row;
}

/// Least squares over the columns in `passive`, 0 elsewhere.
Eigen::VectorXd solve_passive(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                              const std::vector<bool>& passive) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    if (passive[static_cast<std::size_t>(i)]) columns.push_back(i);
  }
  const Eigen::VectorXd part = a(Eigen::all, columns).colPivHouseholderQr().solve(b);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
  x(columns) = part;
  return x;
}

/// min |a x - b| with x >= 0: the active-set method of Lawson and Hanson (1974), chapter 23. Columns of `a`
/// have unit length or are zero.
Eigen::VectorXd non_negative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::Index n = a.cols();
  const double tolerance = 1e-12 * (1.0 + b.norm());
  std::vector<bool> passive(static_cast<std::size_t>(n), false);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  for (Eigen::Index step = 0; step < 3 * n; ++step) {
    const Eigen::VectorXd gradient = a.transpose() * (b - a * x);
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (passive[static_cast<std::size_t>(i)] || gradient[i] <= tolerance) continue;
      if (best < 0 || gradient[i] > gradient[best]) best = i;
    }
    if (best < 0) break;
    passive[static_cast<std::size_t>(best)] = true;
    while (true) {
      const Eigen::VectorXd candidate = solve_passive(a, b, passive);
      double fraction = 1.0;  // of the way to the candidate until a coefficient would become negative
      for (Eigen::Index i = 0; i < n; ++i) {
        if (passive[static_cast<std::size_t>(i)] && candidate[i] <= 0) {
          fraction = std::min(fraction, x[i] / std::max(x[i] - candidate[i], 1e-300));
        }
      }
      x += fraction * (candidate - x);
      if (fraction == 1.0) break;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (passive[static_cast<std::size_t>(i)] && candidate[i] <= 0 && x[i] <= 1e-14) {
          passive[static_cast<std::size_t>(i)] = false;
          x[i] = 0;
        }
      }
    }
  }
  return x;
}

CostModel model_from(const Eigen::VectorXd& x, const std::string& name) {
  CostModel model;
  model.name = name;
  model.base_ns = {.cast = x[0], .warp = x[1], .update = x[2]};
  model.item_ns = {
      .ray = x[3], .sample = x[4], .skip_step = x[5], .shading_fetch = x[6], .texel = x[7], .byte = x[8]};
  return model;
}

}  // namespace

CostFit fit_cost_model(std::span<const CostSample> samples, const std::string& name) {
  std::vector<const CostSample*> used;
  for (const CostSample& sample : samples) {
    if (sample.time > SimDuration(0)) used.push_back(&sample);
  }
  if (used.empty()) throw input_error("cost model '{}': no measured job to fit to", name);

  Eigen::MatrixXd a(static_cast<Eigen::Index>(used.size()), column_count);
  for (std::size_t i = 0; i < used.size(); ++i) {
    a.row(static_cast<Eigen::Index>(i)) = counts_row(*used[i]) / static_cast<double>(used[i]->time.count());
  }
  Eigen::VectorXd lengths = a.colwise().norm();
  CostFit fit;
  for (Eigen::Index i = 0; i < column_count; ++i) {
    if (lengths[i] == 0) {
      fit.unobserved.emplace_back(column_names[static_cast<std::size_t>(i)]);
      lengths[i] = 1;
    }
    a.col(i) /= lengths[i];
  }
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(a.rows());
  const Eigen::VectorXd x = non_negative_least_squares(a, ones);
  const Eigen::VectorXd residual = a * x - ones;
  fit.rms_relative_error = std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
  fit.max_relative_error = residual.cwiseAbs().maxCoeff();
  fit.model = model_from(x.cwiseQuotient(lengths), name);
  return fit;
}

}  // namespace brace
