#include "runtime/volume/transfer_function.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace brace {
namespace {

constexpr double largest_value = 1e300;  // differences of values stay finite

double mix(double a, double b, double t) {
  return (1 - t) * a + t * b;
}

TransferSample mix(const TransferSample& a, const TransferSample& b, double t) {
  return {mix(a.r, b.r, t), mix(a.g, b.g, t), mix(a.b, b.b, t), mix(a.kappa, b.kappa, t)};
}

bool in_unit_interval(double value) {
  return value >= 0 && value <= 1;
}

/// Maps every point's value linearly from [from_min, from_max] to [to.min, to.max].
void map_values(TransferFunction& tf, ValueRange from, ValueRange to) {
  for (TransferPoint& point : tf.points)
    point.value = mix(to.min, to.max, (point.value - from.min) / (from.max - from.min));
}

ValueRange interval_of(const Window& window) {
  return {window.level - window.width / 2, window.level + window.width / 2};
}

ValueRange widened(ValueRange range) {
  if (range.max > range.min) return range;
  if (range.min == 0) return {0, 1};
  return {std::min(0.0, range.min), std::max(0.0, range.min)};
}

/// Multiplied before divided, so that a layout with an entry per integer has its entries exactly there.
double entry_value(const ValueRange& range, std::size_t i, std::size_t entries) {
  return range.min + (range.max - range.min) * static_cast<double>(i) / static_cast<double>(entries - 1);
}

}  // namespace

double kappa_from_opacity(double opacity, double reference_length) {
  if (!in_unit_interval(opacity)) throw input_error("an opacity of {} (accepted: 0 to 1)", opacity);
  if (!(reference_length > 0 && std::isfinite(reference_length)))
    throw input_error("a reference length of {} (accepted: above 0)", reference_length);
  const double kappa = std::min(-std::log1p(-opacity), opaque_optical_depth) / reference_length;
  if (!(kappa <= kappa_limit))
    throw input_error("an opacity of {} per {} voxels is an absorption above {:g}", opacity, reference_length,
                      kappa_limit);
  return kappa;
}

double opacity_from_kappa(double kappa, double length) {
  return -std::expm1(-kappa * length);
}

double opacity_corrected(double alpha, double rho) {
  BRACE_CHECK(in_unit_interval(alpha) && rho >= 0);
  if (rho == 0) return 0;  // also for alpha = 1, where the formula has 0 times infinity
  return -std::expm1(rho * std::log1p(-alpha));
}

void validate(const TransferFunction& tf) {
  if (tf.points.empty())
    throw input_error("{}: the transfer function has no points (accepted: 1 or more)", tf.source);
  for (std::size_t i = 0; i < tf.points.size(); ++i) {
    const auto& [value, sample] = tf.points[i];
    if (!(std::abs(value) <= largest_value))
      throw input_error("{}: point {}: a value of {} (accepted: finite, up to {:g})", tf.source, i, value,
                        largest_value);
    if (i > 0 && !(value > tf.points[i - 1].value))
      throw input_error(
          "{}: point {}: the value {} does not exceed {} before it (accepted: increasing values)", tf.source,
          i, value, tf.points[i - 1].value);
    for (const double channel : {sample.r, sample.g, sample.b})
      if (!in_unit_interval(channel))
        throw input_error("{}: point {}: a colour of {} (accepted: 0 to 1)", tf.source, i, channel);
    if (!(sample.kappa >= 0 && sample.kappa <= kappa_limit))
      throw input_error("{}: point {}: an absorption of {} (accepted: 0 to {:g})", tf.source, i, sample.kappa,
                        kappa_limit);
  }
  if (tf.window &&
      !(std::isfinite(tf.window->level) && tf.window->width > 0 && std::isfinite(tf.window->width)))
    throw input_error("{}: a window of level {} and width {} (accepted: a width above 0)", tf.source,
                      tf.window->level, tf.window->width);
}

TransferFunction with_window(const TransferFunction& tf, Window window) {
  TransferFunction moved = tf;
  moved.window = window;
  validate(moved);
  if (tf.domain == ValueDomain::fraction) return moved;
  moved.window.reset();
  if (tf.points.size() > 1)
    map_values(moved, {tf.points.front().value, tf.points.back().value}, interval_of(window));
  validate(moved);
  return moved;
}

TransferFunction resolve(const TransferFunction& tf, ValueRange data_range, double voxel_length_m) {
  validate(tf);
  TransferFunction resolved = tf;
  if (tf.domain == ValueDomain::fraction) {
    BRACE_CHECK(std::isfinite(data_range.min) && std::isfinite(data_range.max) &&
                data_range.max >= data_range.min);
    map_values(resolved, {0, 1}, tf.window ? interval_of(*tf.window) : widened(data_range));
    resolved.domain = ValueDomain::data;
  }
  resolved.window.reset();
  if (tf.unit == AbsorptionUnit::per_metre) {
    BRACE_CHECK(voxel_length_m > 0 && std::isfinite(voxel_length_m));
    for (TransferPoint& point : resolved.points)
      point.sample.kappa *= voxel_length_m;
    resolved.unit = AbsorptionUnit::per_voxel;
  }
  validate(resolved);
  return resolved;
}

TransferSample evaluate(const TransferFunction& resolved, double value) {
  BRACE_CHECK(resolved.domain == ValueDomain::data && resolved.unit == AbsorptionUnit::per_voxel);
  const auto& points = resolved.points;
  if (std::isnan(value)) return {};
  if (value <= points.front().value) return points.front().sample;
  if (value >= points.back().value) return points.back().sample;
  const auto above =
      std::ranges::upper_bound(points, value, {}, [](const TransferPoint& point) { return point.value; });
  const TransferPoint& high = *above;
  const TransferPoint& low = *(above - 1);
  return mix(low.sample, high.sample, (value - low.value) / (high.value - low.value));
}

TableLayout table_layout(VoxelType type, ValueRange data_range) {
  if (type == VoxelType::uint8) return {{0, 255}, 256};
  const double span = data_range.max - data_range.min;
  const bool integer = type != VoxelType::float32;
  if (integer && span <= max_table_entries - 1) {
    const int steps = std::max(static_cast<int>(span), min_table_entries - 1);
    return {{data_range.min, data_range.min + steps}, steps + 1};
  }
  return {widened(data_range), max_table_entries};
}

TransferTable bake(const TransferFunction& resolved, const TableLayout& layout) {
  if (layout.entries < min_table_entries || layout.entries > max_table_entries)
    throw input_error("{}: a table of {} entries (accepted: {} to {})", resolved.source, layout.entries,
                      min_table_entries, max_table_entries);
  BRACE_CHECK(layout.range.max > layout.range.min && std::isfinite(layout.range.max - layout.range.min));
  TransferTable table{layout.range, {}};
  const auto entries = static_cast<std::size_t>(layout.entries);
  table.entries.reserve(entries);
  for (std::size_t i = 0; i < entries; ++i) {
    const TransferSample sample = evaluate(resolved, entry_value(layout.range, i, entries));
    table.entries.push_back({sample.r, sample.g, sample.b, sample.kappa});
  }
  return table;
}

TransferSample lookup(const TransferTable& table, double value) {
  if (std::isnan(value)) return {};
  const double last = static_cast<double>(table.entries.size() - 1);
  const double scale = last / (table.range.max - table.range.min);
  const double u = std::clamp((value - table.range.min) * scale, 0.0, last);
  const double i = std::min(std::floor(u), last - 1);
  const auto& low = table.entries[static_cast<std::size_t>(i)];
  const auto& high = table.entries[static_cast<std::size_t>(i) + 1];
  return mix({low[0], low[1], low[2], low[3]}, {high[0], high[1], high[2], high[3]}, u - i);
}

std::vector<std::array<float, 4>> float_entries(const TransferTable& table) {
  std::vector<std::array<float, 4>> result;
  result.reserve(table.entries.size());
  for (const auto& entry : table.entries)
    result.push_back({static_cast<float>(entry[0]), static_cast<float>(entry[1]),
                      static_cast<float>(entry[2]), static_cast<float>(entry[3])});
  return result;
}

bool loses_a_point(const TransferFunction& resolved, const TransferTable& table) {
  return std::ranges::any_of(resolved.points, [&](const TransferPoint& point) {
    const bool inside = point.value >= table.range.min && point.value <= table.range.max;
    return inside && point.sample.kappa > 0 && !(lookup(table, point.value).kappa > 0);
  });
}

}  // namespace brace
