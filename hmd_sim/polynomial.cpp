#include "hmd_sim/polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/error.hpp"

namespace brace::sim {
namespace {

// p has opposite signs (or a zero) at the ends and is monotone between them.
double bisect(const Polynomial& p, double low, double high) {
  const bool rising = evaluate(p, low) < evaluate(p, high);
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    ((evaluate(p, middle) > 0.0) == rising ? high : low) = middle;
  }
  return high;
}

// Ascending x in [0, x_max] where p has a root.
std::vector<double> roots(const Polynomial& p, double x_max) {
  if (p.size() < 2) return {};
  std::vector<double> ends = roots(derivative(p), x_max);
  ends.push_back(x_max);
  std::vector<double> found;
  double low = 0.0;
  for (const double high : ends) {
    const double at_low = evaluate(p, low), at_high = evaluate(p, high);
    if ((at_low < 0.0 && at_high >= 0.0) || (at_low > 0.0 && at_high <= 0.0)) {
      found.push_back(bisect(p, low, high));
    }
    low = high;
  }
  return found;
}

}  // namespace

double evaluate(const Polynomial& p, double x) {
  double value = 0.0;
  for (auto k = p.rbegin(); k != p.rend(); ++k)
    value = value * x + *k;
  return value;
}

Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  for (std::size_t i = 1; i < p.size(); ++i)
    d.push_back(p[i] * static_cast<double>(i));
  return d;
}

Polynomial times_x(const Polynomial& p) {
  Polynomial shifted{0.0};
  shifted.insert(shifted.end(), p.begin(), p.end());
  return shifted;
}

Polynomial scaled(const Polynomial& p, double factor) {
  Polynomial s = p;
  for (double& k : s)
    k *= factor;
  return s;
}

Polynomial sum(const Polynomial& a, const Polynomial& b) {
  Polynomial s(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    s[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i)
    s[i] += b[i];
  return s;
}

Polynomial product(const Polynomial& a, const Polynomial& b) {
  if (a.empty() || b.empty()) return {};
  Polynomial m(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j)
      m[i + j] += a[i] * b[j];
  }
  return m;
}

double first_nonpositive(const Polynomial& p, double x_max) {
  BRACE_CHECK(std::isfinite(x_max) && x_max >= 0.0);
  if (evaluate(p, 0.0) <= 0.0) return 0.0;
  std::vector<double> ends = roots(derivative(p), x_max);
  ends.push_back(x_max);
  double low = 0.0;
  for (const double high : ends) {
    if (evaluate(p, high) <= 0.0) return bisect(p, low, high);
    low = high;
  }
  return x_max;
}

}  // namespace brace::sim
