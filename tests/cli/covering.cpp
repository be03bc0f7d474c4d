#include "tests/cli/covering.hpp"

#include <set>
#include <stdexcept>
#include <tuple>

namespace brace::test {

namespace {

constexpr std::size_t open = static_cast<std::size_t>(-1);  // a factor without a value yet

/// Two factors, the lower first, and a value of each.
using Pair = std::tuple<std::size_t, std::size_t, std::size_t, std::size_t>;

Pair pair_of(std::size_t f, std::size_t value, std::size_t g, std::size_t other) {
  return f < g ? Pair{f, g, value, other} : Pair{g, f, other, value};
}

bool apart(const Excludes& excludes, const std::string& a, const std::string& b) {
  return excludes(a, b) || excludes(b, a);
}

/// Whether `value` of factor `f` goes together with all that is chosen.
bool fits(const std::vector<Factor>& factors, const Excludes& excludes, const Combination& chosen,
          std::size_t f, std::size_t value) {
  for (std::size_t g = 0; g < factors.size(); ++g)
    if (g != f && chosen[g] != open &&
        apart(excludes, factors[f].values[value], factors[g].values[chosen[g]]))
      return false;
  return true;
}

std::size_t pairs_gained(const std::set<Pair>& missing, const Combination& chosen, std::size_t f,
                         std::size_t value) {
  std::size_t gained = 0;
  for (std::size_t g = 0; g < chosen.size(); ++g)
    if (g != f && chosen[g] != open) gained += missing.count(pair_of(f, value, g, chosen[g]));
  return gained;
}

/// The value that fits and gains most; among equals the first from `turn` on, so that none is left behind.
std::size_t best_value(const std::vector<Factor>& factors, const Excludes& excludes,
                       const std::set<Pair>& missing, const Combination& chosen, std::size_t f,
                       std::size_t turn) {
  std::size_t best = open, best_gain = 0;
  const std::size_t count = factors[f].values.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t value = (i + turn) % count;
    if (!fits(factors, excludes, chosen, f, value)) continue;
    const std::size_t gain = pairs_gained(missing, chosen, f, value);
    if (best != open && gain <= best_gain) continue;
    best = value;
    best_gain = gain;
  }
  if (best == open) throw std::runtime_error(factors[f].name + ": no value goes with those of the others");
  return best;
}

}  // namespace

std::vector<Combination> covering_pairs(const std::vector<Factor>& factors, const Excludes& excludes) {
  std::set<Pair> missing;
  for (std::size_t f = 0; f < factors.size(); ++f)
    for (std::size_t g = f + 1; g < factors.size(); ++g)
      for (std::size_t a = 0; a < factors[f].values.size(); ++a)
        for (std::size_t b = 0; b < factors[g].values.size(); ++b)
          if (!apart(excludes, factors[f].values[a], factors[g].values[b])) missing.insert({f, g, a, b});
  std::vector<Combination> rows;
  while (!missing.empty()) {
    Combination row(factors.size(), open);
    const auto [f, g, a, b] = *missing.begin();
    row[f] = a;
    row[g] = b;
    for (std::size_t h = 0; h < factors.size(); ++h)
      if (row[h] == open) row[h] = best_value(factors, excludes, missing, row, h, rows.size());
    for (std::size_t h = 0; h < factors.size(); ++h)
      for (std::size_t k = h + 1; k < factors.size(); ++k)
        missing.erase({h, k, row[h], row[k]});
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Combination> all_combinations(const std::vector<Factor>& factors, const Excludes& excludes) {
  std::vector<Combination> rows = {Combination(factors.size(), open)};
  for (std::size_t f = 0; f < factors.size(); ++f) {
    std::vector<Combination> longer;
    for (const Combination& row : rows) {
      for (std::size_t value = 0; value < factors[f].values.size(); ++value) {
        if (!fits(factors, excludes, row, f, value)) continue;
        longer.push_back(row);
        longer.back()[f] = value;
      }
    }
    rows = std::move(longer);
  }
  return rows;
}

ValuePairs value_pairs(const std::vector<Factor>& factors, const Excludes& excludes) {
  ValuePairs pairs;
  for (std::size_t f = 0; f < factors.size(); ++f)
    for (std::size_t g = f + 1; g < factors.size(); ++g)
      for (const std::string& a : factors[f].values)
        for (const std::string& b : factors[g].values)
          (apart(excludes, a, b) ? pairs.apart : pairs.together).emplace_back(a, b);
  return pairs;
}

}  // namespace brace::test
