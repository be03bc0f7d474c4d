#pragma once

#include <vector>

namespace brace::sim {

/// Coefficients in ascending powers. Small and slow on purpose: used once per lens, not per pixel.
using Polynomial = std::vector<double>;

double evaluate(const Polynomial& p, double x);
Polynomial derivative(const Polynomial& p);
Polynomial times_x(const Polynomial& p);
Polynomial scaled(const Polynomial& p, double factor);
Polynomial sum(const Polynomial& a, const Polynomial& b);
Polynomial product(const Polynomial& a, const Polynomial& b);

/// The smallest x in [0, x_max] with p(x) <= 0; x_max if p stays positive. Finds it however near two roots
/// lie, because p is monotone between the roots of its derivative, which are found the same way.
double first_nonpositive(const Polynomial& p, double x_max);

}  // namespace brace::sim
