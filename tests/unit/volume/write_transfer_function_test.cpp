#include "runtime/volume/write_transfer_function.hpp"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/error.hpp"

namespace brace {
namespace {

void expect_same(const TransferFunction& a, const TransferFunction& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.domain, b.domain);
  EXPECT_EQ(a.unit, b.unit);
  ASSERT_EQ(a.window.has_value(), b.window.has_value());
  if (a.window) {
    EXPECT_EQ(a.window->level, b.window->level);
    EXPECT_EQ(a.window->width, b.window->width);
  }
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].value, b.points[i].value);
    EXPECT_EQ(a.points[i].sample.r, b.points[i].sample.r);
    EXPECT_EQ(a.points[i].sample.g, b.points[i].sample.g);
    EXPECT_EQ(a.points[i].sample.b, b.points[i].sample.b);
    EXPECT_EQ(a.points[i].sample.kappa, b.points[i].sample.kappa);
  }
}

TEST(WriteTransferFunction, ReadsBackToTheLastBit) {
  TransferFunction tf;
  tf.name = "a \"name\" with \\ and more";
  tf.points = {{-1024.0 / 3.0, {0.1, 1.0 / 3.0, 1.0, 0.0}},
               {0.0, {0.0, 0.5, 0.25, 1e-300}},
               {1e-9, {1.0, 0.0, 1e-17, opaque_optical_depth}},
               {3071.0, {0.7, 0.7, 0.7, kappa_limit}}};
  expect_same(parse_transfer_function(transfer_function_toml(tf), "test"), tf);
  tf.domain = ValueDomain::fraction;
  tf.window = Window{40.1, 400.0 / 7.0};
  tf.unit = AbsorptionUnit::per_metre;
  expect_same(parse_transfer_function(transfer_function_toml(tf), "test"), tf);
}

TEST(WriteTransferFunction, ReplacesAFileOrSaysThatItCannot) {
  TransferFunction tf;
  tf.points = {{0.0, {1, 1, 1, 0.5}}};
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("brace-tf-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / "tf.toml";
  write_transfer_function(file, tf);
  tf.points[0].sample.kappa = 0.25;
  write_transfer_function(file, tf);
  EXPECT_EQ(load_transfer_function(file.string(), folder).points[0].sample.kappa, 0.25);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1)
      << "nothing else is left there";
  try {
    write_transfer_function(folder / "none" / "tf.toml", tf);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("none/tf.toml"));
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace brace
