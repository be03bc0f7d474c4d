#pragma once

#include <functional>
#include <string>
#include <vector>

#include "runtime/verify/verify.hpp"

namespace brace {

/// A defect in one of the product's functions, and the group of claims that must find it.
struct PlantedDefect {
  std::string name;
  std::string group;
  std::function<void(VerifySubjects&)> plant;
};

std::vector<PlantedDefect> defects_in_casts();
std::vector<PlantedDefect> defects_in_numbers();
std::vector<PlantedDefect> defects_in_stereo_and_control();

}  // namespace brace
