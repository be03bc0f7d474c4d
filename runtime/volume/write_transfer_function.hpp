#pragma once

#include <filesystem>
#include <string>

#include "runtime/volume/transfer_function.hpp"

namespace brace {

/// A valid transfer function in the form that parse_transfer_function reads, to the last bit: absorptions,
/// not opacities.
std::string transfer_function_toml(const TransferFunction& tf);

/// Throws input_error naming the file when it cannot be written; there is then no half of it.
void write_transfer_function(const std::filesystem::path& file, const TransferFunction& tf);

}  // namespace brace
