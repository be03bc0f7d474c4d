#include "runtime/volume/transfer_function.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include "tests/unit/volume/support.hpp"

namespace brace {
namespace {

using testing::HasSubstr;

constexpr double nan_coordinate = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TransferFunction function_of(std::vector<TransferPoint> points) {
  TransferFunction tf;
  tf.source = "test";
  tf.points = std::move(points);
  return tf;
}

TransferFunction parse(const std::string& text) {
  return parse_transfer_function(text, "tf.toml");
}

std::string parse_error(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    return error.what();
  }
  ADD_FAILURE() << "no error for: " << text;
  return "";
}

std::string point(const std::string& value, const std::string& density, const std::string& r = "0.5") {
  return "  { value = " + value + ", r = " + r + ", g = 0.25, b = 1, " + density + " },\n";
}

std::string points(const std::string& inside) {
  return "points = [\n" + inside + "]\n";
}

TEST(Opacity, KappaRoundTripsAndOneIsClamped) {
  for (const double alpha : {0.0, 1e-12, 1e-3, 0.3, 0.999, 1 - 1e-7}) {
    for (const double length : {0.25, 1.0, 8.0}) {
      const double kappa = kappa_from_opacity(alpha, length);
      EXPECT_NEAR(opacity_from_kappa(kappa, length), alpha, 1e-15 + 1e-12 * alpha);
    }
  }
  EXPECT_EQ(kappa_from_opacity(0, 1), 0);
  EXPECT_EQ(kappa_from_opacity(1, 2), opaque_optical_depth / 2);
  EXPECT_EQ(static_cast<float>(opacity_from_kappa(opaque_optical_depth, 1)), std::nextafter(1.0F, 0.0F));
  EXPECT_NEAR(opaque_optical_depth, 24 * std::log(2), 1e-15);
  for (const double bad : {-0.1, 1.1, nan_coordinate})
    EXPECT_THROW(kappa_from_opacity(bad, 1), Error);
  for (const double bad : {0.0, -1.0, nan_coordinate, infinity})
    EXPECT_THROW(kappa_from_opacity(0.5, bad), Error);
  EXPECT_THROW(kappa_from_opacity(0.5, 1e-300), Error) << "above kappa_limit";
}

TEST(Opacity, CorrectedForAStepEqualsSteppingInParts) {
  for (const double alpha : {0.0, 1e-9, 0.2, 0.95}) {
    const double half = opacity_corrected(alpha, 0.5);
    EXPECT_NEAR(1 - (1 - half) * (1 - half), alpha, 1e-15);
    EXPECT_NEAR(opacity_corrected(alpha, 3), 1 - std::pow(1 - alpha, 3), 1e-15);
    EXPECT_NEAR(opacity_corrected(alpha, 1), alpha, 1e-16);
    EXPECT_EQ(opacity_corrected(alpha, 0), 0);
  }
  EXPECT_EQ(opacity_corrected(1, 1e-6), 1);
  EXPECT_EQ(opacity_corrected(1, 0), 0);
  EXPECT_EQ(opacity_corrected(0, 1e12), 0);
  EXPECT_NEAR(opacity_corrected(1e-18, 2), 2e-18, 1e-30) << "no cancellation for thin steps";
}

TEST(TransferFunction, IsLinearBetweenItsPointsAndConstantOutside) {
  const auto tf = function_of({{10, {0, 0.5, 1, 2}}, {20, {1, 0.5, 0, 6}}});
  const TransferSample middle = evaluate(tf, 12.5);
  EXPECT_DOUBLE_EQ(middle.r, 0.25);
  EXPECT_DOUBLE_EQ(middle.g, 0.5);
  EXPECT_DOUBLE_EQ(middle.b, 0.75);
  EXPECT_DOUBLE_EQ(middle.kappa, 3);
  for (const double below : {10.0, -1e30, -infinity})
    EXPECT_EQ(evaluate(tf, below).kappa, 2);
  for (const double above : {20.0, 1e30, infinity})
    EXPECT_EQ(evaluate(tf, above).kappa, 6);
  const TransferSample nothing = evaluate(tf, nan_coordinate);
  EXPECT_EQ(nothing.kappa + nothing.r + nothing.g + nothing.b, 0);
  EXPECT_EQ(evaluate(function_of({{5, {1, 1, 1, 4}}}), -100).kappa, 4) << "one point is a constant";
}

TEST(TransferFunction, TomlGivesColoursAndEitherDensity) {
  const auto tf = parse(
      "name = \"n\"\nreference_length = 2\n" +
      points(point("-5", "opacity = 0") + point("1.5", "opacity = 0.75") + point("2", "absorption = 1e12")));
  EXPECT_EQ(tf.name, "n");
  ASSERT_EQ(tf.points.size(), 3U);
  EXPECT_EQ(tf.points[0].value, -5);
  EXPECT_EQ(tf.points[0].sample.kappa, 0);
  EXPECT_EQ(tf.points[1].sample.r, 0.5);
  EXPECT_EQ(tf.points[1].sample.g, 0.25);
  EXPECT_EQ(tf.points[1].sample.b, 1);
  EXPECT_NEAR(tf.points[1].sample.kappa, std::log(2), 1e-15);  // 1 - exp(-2 kappa) = 3/4
  EXPECT_EQ(tf.points[2].sample.kappa, 1e12);
}

TEST(TransferFunction, WrongFilesSayFileLineAndWhatIsAccepted) {
  const std::string good = point("0", "opacity = 0.5");
  EXPECT_THAT(parse_error("points = []\n"), HasSubstr("tf.toml: the transfer function has no points"));
  EXPECT_THAT(parse_error("name = \"x\"\n"), HasSubstr("'points' is missing"));
  EXPECT_THAT(parse_error(points(good + good)), HasSubstr("does not exceed 0 before it"));
  EXPECT_THAT(parse_error(points(good + point("-1", "opacity = 0"))), HasSubstr("increasing values"));
  EXPECT_THAT(parse_error(points(point("nan", "opacity = 0"))), HasSubstr("a value of nan"));
  EXPECT_THAT(parse_error(points(point("inf", "opacity = 0"))), HasSubstr("a value of inf"));
  EXPECT_THAT(parse_error(points(good + point("1", "opacity = 1.5"))),
              testing::AllOf(HasSubstr("tf.toml:3"), HasSubstr("0 to 1")));
  EXPECT_THAT(parse_error(points(point("0", "opacity = nan"))), HasSubstr("an opacity of nan"));
  EXPECT_THAT(parse_error(points(point("0", "absorption = -1"))), HasSubstr("an absorption of -1"));
  EXPECT_THAT(parse_error(points(point("0", "absorption = 2e12"))), HasSubstr("accepted: 0 to 1e+12"));
  EXPECT_THAT(parse_error(points(point("0", "absorption = nan"))), HasSubstr("an absorption of nan"));
  EXPECT_THAT(parse_error(points(point("0", "opacity = 0", "1.01"))), HasSubstr("a colour of 1.01"));
  EXPECT_THAT(parse_error(points(point("0", "opacity = 0", "\"red\""))),
              HasSubstr("'r' is missing or not a number"));
  EXPECT_THAT(parse_error(points(point("0", "opacity = 0, absorption = 1"))),
              HasSubstr("either 'opacity' or 'absorption'"));
  EXPECT_THAT(parse_error(points("  { value = 0, r = 0, g = 0, b = 0 },\n")),
              HasSubstr("either 'opacity' or 'absorption'"));
  EXPECT_THAT(parse_error(points(point("0", "opacty = 0"))), HasSubstr("did you mean 'opacity'"));
  EXPECT_THAT(parse_error(points("3\n")), HasSubstr("accepted: a point such as { value"));
  EXPECT_THAT(parse_error("pints = 1\n" + points(good)), HasSubstr("did you mean 'points'"));
  EXPECT_THAT(parse_error("domain = \"frac\"\n" + points(good)), HasSubstr("accepted: data, fraction"));
  EXPECT_THAT(parse_error("reference_length = 0\n" + points(good)), HasSubstr("a reference length of 0"));
  EXPECT_THAT(parse_error("window = 4\n" + points(good)), HasSubstr("domain = \"fraction\""));
  EXPECT_THAT(parse_error("domain = \"fraction\"\nwindow = 4\n" + points(good)),
              HasSubstr("'level' is missing"));
  EXPECT_THAT(parse_error("domain = \"fraction\"\nwindow = 0\nlevel = 1\n" + points(good)),
              HasSubstr("a width above 0"));
  EXPECT_THAT(parse_error("absorption_unit = \"per_metre\"\n" + points(good)),
              HasSubstr("give 'absorption'"));
}

TEST(TransferFunction, FractionsGoOverTheDataOrTheWindow) {
  const std::string two = points(point("0", "absorption = 0") + point("1", "absorption = 1"));
  const auto over_data = resolve(parse("domain = \"fraction\"\n" + two), {-100, 300});
  EXPECT_EQ(over_data.points[0].value, -100);
  EXPECT_EQ(over_data.points[1].value, 300);
  const auto windowed = parse("domain = \"fraction\"\nlevel = 40\nwindow = 400\n" + two);
  EXPECT_EQ(resolve(windowed, {0, 1}).points[0].value, -160);
  EXPECT_EQ(resolve(windowed, {0, 1}).points[1].value, 240);
  const auto moved = resolve(with_window(windowed, {10, 4}), {0, 1});
  EXPECT_EQ(moved.points[0].value, 8);
  EXPECT_EQ(moved.points[1].value, 12);
  const auto in_data_units = with_window(parse(two), {10, 4});
  EXPECT_EQ(in_data_units.points[0].value, 8);
  EXPECT_EQ(in_data_units.points[1].value, 12);
  EXPECT_THROW(with_window(windowed, {0, 0}), Error);
  EXPECT_THROW(with_window(windowed, {nan_coordinate, 1}), Error);
}

TEST(TransferFunction, ConstantDataHasAStatedRange) {
  const auto tf =
      parse("domain = \"fraction\"\n" + points(point("0", "absorption = 0") + point("1", "absorption = 1")));
  const auto range_of = [&](double value) {
    const auto resolved = resolve(tf, {value, value});
    return std::pair{resolved.points[0].value, resolved.points[1].value};
  };
  EXPECT_EQ(range_of(255), (std::pair{0.0, 255.0}));
  EXPECT_EQ(range_of(-3), (std::pair{-3.0, 0.0}));
  EXPECT_EQ(range_of(0), (std::pair{0.0, 1.0}));
}

TEST(TransferFunction, AbsorptionPerMetreTakesTheVoxelsLength) {
  const auto tf = parse("absorption_unit = \"per_metre\"\n" + points(point("0", "absorption = 500")));
  EXPECT_DOUBLE_EQ(resolve(tf, {0, 1}, 0.002).points[0].sample.kappa, 1.0);
}

TEST(TransferTable, EntriesAndLookupAreTheDocumentedDefinition) {
  const auto tf = function_of({{-4, {0, 0.2, 1, 0}}, {3, {1, 0.4, 0.5, 8}}, {9, {0.3, 0, 0, 1e12}}});
  const TransferTable table = bake(tf, {{-5, 10}, 301});
  ASSERT_EQ(table.entries.size(), 301U);
  for (std::size_t i = 0; i < 301; ++i) {
    const TransferSample sample = evaluate(tf, -5 + 15.0 * static_cast<double>(i) / 300);
    EXPECT_EQ(table.entries[i][0], sample.r);
    EXPECT_EQ(table.entries[i][3], sample.kappa);
    EXPECT_EQ(float_entries(table)[i][3], static_cast<float>(sample.kappa));
  }
  // Between entries 100 and 101 at 0.25, written out by hand: v = -5 + 15 * 100.25 / 300.
  const TransferSample between = lookup(table, -5 + 15 * 100.25 / 300);
  for (const auto& [got, channel] :
       {std::pair{between.r, 0U}, {between.g, 1U}, {between.b, 2U}, {between.kappa, 3U}})
    EXPECT_NEAR(got, 0.75 * table.entries[100][channel] + 0.25 * table.entries[101][channel], 1e-12);
  for (const double below : {-5.0, -6.0, -infinity})
    EXPECT_EQ(lookup(table, below).kappa, table.entries[0][3]);
  for (const double above : {10.0, 11.0, infinity})
    EXPECT_EQ(lookup(table, above).kappa, table.entries[300][3]);
  EXPECT_EQ(lookup(table, nan_coordinate).kappa, 0);
}

TEST(TransferTable, ConvergesToTheFunctionWithItsEntries) {
  const auto tf = load_transfer_function("ct-bone", preset_folder());
  double last = infinity;
  for (const int entries : {256, 1024, 4096}) {
    const TransferTable table = bake(tf, {{-1024, 2986}, entries});
    double worst = 0;
    for (double value = -1024; value <= 2986; value += 0.37)
      worst = std::max(worst, std::abs(lookup(table, value).kappa - evaluate(tf, value).kappa));
    EXPECT_LT(worst, 0.7 * last);
    last = worst;
  }
  EXPECT_LT(last, 2e-3);
}

TEST(TransferTable, LayoutPutsAnEntryOnEveryIntegerValue) {
  const auto tf = function_of({{0, {0, 0, 0, 0}}, {4095, {1, 1, 1, 4095}}});
  const auto exact = [&](VoxelType type, ValueRange range) {
    const TransferTable table = bake(tf, table_layout(type, range));
    for (double value = range.min; value <= range.max; ++value)
      if (lookup(table, value).kappa != evaluate(tf, value).kappa) return false;
    return true;
  };
  EXPECT_TRUE(exact(VoxelType::uint8, {3, 130}));
  EXPECT_TRUE(exact(VoxelType::uint16, {0, 4095}));
  EXPECT_TRUE(exact(VoxelType::int16, {-1024, 2986}));
  EXPECT_TRUE(exact(VoxelType::int16, {7, 7}));
  EXPECT_EQ(table_layout(VoxelType::int16, {-1024, 2986}).entries, 4011);
  EXPECT_EQ(table_layout(VoxelType::uint16, {5, 9}).entries, 256);
  EXPECT_EQ(table_layout(VoxelType::uint16, {0, 65535}).entries, 4096);
  EXPECT_EQ(table_layout(VoxelType::float32, {2, 2}).range.min, 0) << "never an empty range";
}

TEST(TransferTable, EntryCountIsChecked) {
  const auto tf = function_of({{0, {1, 1, 1, 1}}});
  EXPECT_THROW(bake(tf, {{0, 1}, 255}), Error);
  EXPECT_THROW(bake(tf, {{0, 1}, 4097}), Error);
  EXPECT_EQ(bake(tf, {{0, 1}, 256}).entries.size(), 256U);
}

TEST(TransferTable, SaysWhenABandIsTooNarrowForIt) {
  const auto needle = [](double at) {
    return function_of({{at - 1e-6, {1, 1, 1, 0}}, {at, {1, 1, 1, 100}}, {at + 1e-6, {1, 1, 1, 0}}});
  };
  EXPECT_TRUE(loses_a_point(needle(0.5 / 255), bake(needle(0.5 / 255), {{0, 1}, 256})));
  EXPECT_FALSE(loses_a_point(needle(51.0 / 255), bake(needle(51.0 / 255), {{0, 1}, 256})));
}

TEST(Presets, AllLoadAndHaveTheirNames) {
  EXPECT_THAT(list_transfer_functions(preset_folder()),
              testing::ElementsAre("ct-bone", "ct-soft-tissue", "mri-brain", "tf1", "tf2", "tf3", "tf4",
                                   "tf5", "tf6"));
  for (const std::string& name : list_transfer_functions(preset_folder())) {
    const auto tf = load_transfer_function(name, preset_folder());
    const auto resolved = resolve(tf, {0, 255});
    EXPECT_FALSE(loses_a_point(resolved, bake(resolved, table_layout(VoxelType::uint16, {0, 4000})))) << name;
  }
  try {
    load_transfer_function("ct-bones", preset_folder());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("did you mean 'ct-bone'"), HasSubstr("mri-brain")));
  }
  EXPECT_THROW(load_transfer_function("./none.toml", preset_folder()), Error);
}

TEST(Presets, Tf1ToTf4ShowTheIntensitiesTheirPaperSays) {
  const auto table_of = [](const std::string& name) {
    const auto tf = resolve(load_transfer_function(name, preset_folder()), {0, 1000});
    return bake(tf, table_layout(VoxelType::uint16, {0, 1000}));
  };
  const auto tf1 = table_of("tf1"), tf2 = table_of("tf2"), tf3 = table_of("tf3"), tf4 = table_of("tf4");
  for (int i = 0; i <= 1000; ++i) {
    EXPECT_EQ(lookup(tf1, i).kappa > 0, i > 0) << i;
    EXPECT_GT(lookup(tf2, i).kappa, 0) << i;
    EXPECT_EQ(lookup(tf3, i).kappa > 0, i > 500) << i;
    EXPECT_EQ(lookup(tf4, i).kappa > 0, (i > 250 && i < 500) || i > 750) << i;
  }
  const auto tf6 = table_of("tf6");
  EXPECT_EQ(lookup(tf6, 0).kappa, 0);
  EXPECT_GT(lookup(tf6, 1000.0 / 32).kappa, 0) << "rises within the first of 32 partitions";
}

}  // namespace
}  // namespace brace
