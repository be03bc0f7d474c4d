#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace brace::test {

/// Something that is varied: "pipeline.skip" and its values.
struct Factor {
  std::string name;
  std::vector<std::string> values;
};

/// An index into each factor's values.
using Combination = std::vector<std::size_t>;

/// Whether two values, each of another factor, do not go together; asked in both orders.
using Excludes = std::function<bool(const std::string&, const std::string&)>;

/// Combinations in which every two values that go together meet at least once, and none that do not.
/// Greedy; the same for the same factors. Every value must go together with some value of each other factor.
std::vector<Combination> covering_pairs(const std::vector<Factor>& factors, const Excludes& excludes);

/// All combinations of values that go together.
std::vector<Combination> all_combinations(const std::vector<Factor>& factors, const Excludes& excludes);

/// Pairs of values that go together, and those that do not.
struct ValuePairs {
  std::vector<std::pair<std::string, std::string>> together, apart;
};
ValuePairs value_pairs(const std::vector<Factor>& factors, const Excludes& excludes);

}  // namespace brace::test
