#include "runtime/volume/write_transfer_function.hpp"

#include <fstream>

#include <fmt/core.h>

#include "base/error.hpp"

namespace brace {

namespace {

/// Of a name: quotes, backslashes and control characters would end it.
std::string quoted(const std::string& words) {
  std::string text = "\"";
  for (const char c : words) {
    if (c == '"' || c == '\\') text += '\\';
    text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return text + "\"";
}

}  // namespace

std::string transfer_function_toml(const TransferFunction& tf) {
  std::string text = fmt::format("name = {}\n", quoted(tf.name));
  text += fmt::format("domain = \"{}\"\n", tf.domain == ValueDomain::fraction ? "fraction" : "data");
  if (tf.window) text += fmt::format("level = {}\nwindow = {}\n", tf.window->level, tf.window->width);
  text += fmt::format("absorption_unit = \"{}\"\n",
                      tf.unit == AbsorptionUnit::per_metre ? "per_metre" : "per_voxel");
  text += "points = [\n";
  for (const TransferPoint& point : tf.points) {
    const TransferSample& sample = point.sample;
    text += fmt::format("  {{ value = {}, r = {}, g = {}, b = {}, absorption = {} }},\n", point.value,
                        sample.r, sample.g, sample.b, sample.kappa);
  }
  return text + "]\n";
}

void write_transfer_function(const std::filesystem::path& file, const TransferFunction& tf) {
  const std::filesystem::path fresh = file.string() + ".new";
  std::ofstream stream(fresh, std::ios::binary);
  stream << transfer_function_toml(tf);
  stream.close();
  std::error_code failed;
  if (stream) std::filesystem::rename(fresh, file, failed);
  if (stream && !failed) return;
  std::filesystem::remove(fresh, failed);
  throw input_error("{}: cannot be written", file.string());
}

}  // namespace brace
