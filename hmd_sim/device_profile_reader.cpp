#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "base/toml_file.hpp"
#include "hmd_sim/device_profile.hpp"

namespace brace::sim {
namespace {

/// A table of the file with its place, so that every message can name file, line and full key.
struct Section {
  const toml::table* table;
  std::string file;
  std::string name;  // dotted, "" for the top

  std::string key_name(std::string_view key) const {
    return name.empty() ? std::string(key) : fmt::format("{}.{}", name, key);
  }
  std::string place(std::string_view key) const {
    const toml::node* node = table->get(key);
    return node != nullptr ? place_of(*node, file) : place_of(*table, file);
  }
  [[noreturn]] void fail(std::string_view key, const std::string& what) const {
    throw input_error("{}: key '{}' {}", place(key), key_name(key), what);
  }
  void accept_only(const std::vector<std::string>& known) const {
    reject_unknown_keys(*table, file, name, known);
  }
  const toml::node& node(std::string_view key) const {
    const toml::node* found = table->get(key);
    if (found == nullptr) fail(key, "is missing");
    return *found;
  }
};

Section section(const Section& parent, std::string_view key, const std::vector<std::string>& known) {
  const toml::table* table = parent.node(key).as_table();
  if (table == nullptr) parent.fail(key, "must be a table");
  Section child{table, parent.file, parent.key_name(key)};
  child.accept_only(known);
  return child;
}

double number(const Section& s, std::string_view key, double least, double most) {
  const auto value = s.node(key).is_number() ? s.node(key).value<double>() : std::nullopt;
  if (!value || !(*value >= least && *value <= most)) {
    s.fail(key, fmt::format("must be a number from {} to {}", least, most));
  }
  return *value;
}

std::int64_t integer(const Section& s, std::string_view key, std::int64_t least, std::int64_t most) {
  const auto value = s.node(key).value_exact<std::int64_t>();
  if (!value || *value < least || *value > most) {
    s.fail(key, fmt::format("must be a whole number from {} to {}", least, most));
  }
  return *value;
}

std::string text(const Section& s, std::string_view key) {
  const auto value = s.node(key).value_exact<std::string>();
  if (!value || value->empty()) s.fail(key, "must be a text that is not empty");
  return *value;
}

// A list of `least` to `most` finite numbers.
std::vector<double> numbers(const Section& s, std::string_view key, std::size_t least, std::size_t most) {
  const toml::array* array = s.node(key).as_array();
  const std::string wanted = least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
  if (array == nullptr || array->size() < least || array->size() > most) {
    s.fail(key, fmt::format("must be a list of {} numbers", wanted));
  }
  std::vector<double> values;
  for (const toml::node& entry : *array) {
    const auto value = entry.is_number() ? entry.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value))
      s.fail(key, fmt::format("must be a list of {} finite numbers", wanted));
    values.push_back(*value);
  }
  return values;
}

glm::dvec2 pair(const Section& s, std::string_view key, double least, double most) {
  const std::vector<double> v = numbers(s, key, 2, 2);
  for (const double x : v) {
    if (!(x >= least && x <= most))
      s.fail(key, fmt::format("must be two numbers from {} to {}", least, most));
  }
  return {v[0], v[1]};
}

Rate rate(const Section& s, std::string_view key) {
  const toml::array* array = s.node(key).as_array();
  if (array != nullptr && array->size() == 2) {
    const auto num = (*array)[0].value_exact<std::int64_t>(), den = (*array)[1].value_exact<std::int64_t>();
    const bool in_range = num && den && *num > 0 && *den > 0 && *num <= 1'000'000 && *den <= 9'000;
    if (in_range && *num >= *den) return {*num, *den};
  }
  s.fail(key, "must be [numerator, denominator] in hertz: whole numbers, 1 Hz or more, e.g. [90, 1]");
}

template <typename Enum, std::size_t N>
Enum choice(const Section& s, std::string_view key, const std::array<Enum, N>& all) {
  const std::string value = text(s, key);
  std::vector<std::string> names;
  for (const Enum option : all) {
    if (to_string(option) == value) return option;
    names.emplace_back(to_string(option));
  }
  s.fail(key,
         fmt::format("= '{}' is unknown{}; accepted: {}", value, did_you_mean(value, names), join(names)));
}

FovTangents fov_tangents(const Section& eye) {
  const Section s = section(eye, "fov_tangents", {"left", "right", "bottom", "top"});
  constexpr double most = 20.0;  // 87 degrees
  return {number(s, "left", -most, -1e-3), number(s, "right", 1e-3, most), number(s, "bottom", -most, -1e-3),
          number(s, "top", 1e-3, most)};
}

void read_eye(const Section& eyes, std::string_view side, EyeProfile& eye) {
  const Section s = section(eyes, side, {"fov_tangents", "position_m", "cant_deg"});
  eye.fov = fov_tangents(s);
  const std::vector<double> p = numbers(s, "position_m", 3, 3);
  const double cant_rad = number(s, "cant_deg", -45, 45) * std::numbers::pi / 180.0;
  eye.head_from_eye = {quat_exp({0.0, cant_rad, 0.0}), {p[0], p[1], p[2]}};
}

struct CoefficientCount {
  std::size_t least, most;
};

CoefficientCount coefficient_count(LensKind kind) {
  switch (kind) {
    case LensKind::brown_conrady:
      return {1, 3};
    case LensKind::panotools:
      return {4, 5};
    case LensKind::vive:
      return {3, 4};
    case LensKind::none_published:
    case LensKind::identity:
      break;
  }
  return {0, 0};
}

constexpr std::array<const char*, 3> channel_names{"red", "green", "blue"};

void read_centres(const Section& s, EyeLens& lens) {
  constexpr double least = -1.0, most = 2.0;
  if (!s.node("centre_uv").is_table()) {
    for (LensChannel& channel : lens.rgb)
      channel.centre_uv = pair(s, "centre_uv", least, most);
    return;
  }
  const Section centres = section(s, "centre_uv", {"red", "green", "blue"});
  for (std::size_t c = 0; c < 3; ++c) {
    lens.rgb[c].centre_uv = pair(centres, channel_names[c], least, most);
  }
}

void read_coefficients(const Section& s, EyeLens& lens) {
  const CoefficientCount count = coefficient_count(lens.kind);
  const bool shared = s.table->contains("rgb");
  for (std::size_t c = 0; c < 3; ++c) {
    if (shared && s.table->contains(channel_names[c]))
      s.fail(channel_names[c], "stands beside 'rgb': give one");
    const auto k = numbers(s, shared ? "rgb" : channel_names[c], count.least, count.most);
    std::copy(k.begin(), k.end(), lens.rgb[c].k.begin());
  }
  if (!s.table->contains("scale_rgb")) return;
  if (lens.kind != LensKind::panotools) s.fail("scale_rgb", "is for kind = \"panotools\" alone");
  const std::vector<double> scale = numbers(s, "scale_rgb", 3, 3);
  for (std::size_t c = 0; c < 3; ++c) {
    for (double& k : lens.rgb[c].k)
      k *= scale[c];
  }
}

void read_lens_side(const Section& lens_section, std::string_view side, EyeLens& lens) {
  const Section s = section(lens_section, side,
                            {"panel_size_units", "tan_per_unit", "centre_uv", "rgb", "red", "green", "blue",
                             "scale_rgb", "cutoff_radius"});
  lens.panel_size_units = pair(s, "panel_size_units", 1e-3, 1e3);
  lens.tan_per_unit = pair(s, "tan_per_unit", 1e-3, 1e3);
  if (s.table->contains("cutoff_radius")) lens.cutoff_radius = number(s, "cutoff_radius", 1e-3, 1e3);
  read_centres(s, lens);
  read_coefficients(s, lens);
  for (const Channel channel : all_channels) {
    if (usable_radius(lens, channel) <= 0.0) {
      lens_section.fail(side, "folds over at its centre: its scale must be positive there");
    }
  }
}

void read_lens(const Section& top, DeviceProfile& profile) {
  constexpr std::array kinds{LensKind::none_published, LensKind::identity, LensKind::brown_conrady,
                             LensKind::panotools, LensKind::vive};
  const Section s = section(top, "lens", {"kind", "left", "right"});
  profile.lens_kind = choice(s, "kind", kinds);
  const bool maps_like_identity = coefficient_count(profile.lens_kind).most == 0;
  for (const Eye which : all_eyes) {
    EyeProfile& eye = profile.eyes[static_cast<std::size_t>(which)];
    const char* side = which == Eye::left ? "left" : "right";
    if (maps_like_identity) {
      if (s.table->contains(side)) s.fail(side, "is only for a lens kind with coefficients");
      eye.lens = identity_lens(eye.fov);
    }
    eye.lens.kind = profile.lens_kind;
    if (!maps_like_identity) read_lens_side(s, side, eye.lens);
  }
}

void read_panel(const Section& top, DeviceProfile& profile) {
  constexpr std::int64_t most_px = 16384;
  const Section panel =
      section(top, "panel", {"width_px", "height_px", "refresh_hz", "persistence_ns", "photon_delay_ns"});
  profile.panel_width_px = static_cast<int>(integer(panel, "width_px", 1, most_px));
  profile.panel_height_px = static_cast<int>(integer(panel, "height_px", 1, most_px));
  profile.refresh = rate(panel, "refresh_hz");
  profile.emission.persistence = SimDuration(integer(panel, "persistence_ns", 0, 1'000'000'000));
  profile.emission.delay = SimDuration(integer(panel, "photon_delay_ns", 0, 1'000'000'000));
  if (top.table->contains("render_target")) {
    const Section target = section(top, "render_target", {"width_px", "height_px"});
    profile.target_width_px = static_cast<int>(integer(target, "width_px", 1, most_px));
    profile.target_height_px = static_cast<int>(integer(target, "height_px", 1, most_px));
  }
  constexpr std::array directions{ScanDirection::global, ScanDirection::top_to_bottom,
                                  ScanDirection::bottom_to_top, ScanDirection::left_to_right,
                                  ScanDirection::right_to_left};
  const Section scan = section(top, "scan_out", {"direction", "fraction"});
  profile.scan_out = {choice(scan, "direction", directions), number(scan, "fraction", 0.0, 1.0)};
}

TrackerModel read_tracker(const Section& top) {
  const Section s =
      section(top, "tracker",
              {"rate_hz", "latency_ns", "position_noise_m", "orientation_noise_rad", "dropout_probability"});
  TrackerModel tracker;
  tracker.rate = rate(s, "rate_hz");
  tracker.latency = SimDuration(integer(s, "latency_ns", 0, 1'000'000'000));
  tracker.position_noise_m = number(s, "position_noise_m", 0.0, 1.0);
  tracker.orientation_noise_rad = number(s, "orientation_noise_rad", 0.0, 0.1);
  tracker.dropout_probability = number(s, "dropout_probability", 0.0, 0.99);
  return tracker;
}

// Every key of `assumed` must be one of this file, or the mark would be lost after a renaming.
void collect_keys(const toml::table& table, const std::string& prefix, std::set<std::string>& keys) {
  for (const auto& [key, value] : table) {
    const std::string name = prefix + std::string(key.str());
    keys.insert(name);
    if (const toml::table* child = value.as_table()) collect_keys(*child, name + ".", keys);
  }
}

void read_assumed(const Section& top, DeviceProfile& profile) {
  if (!top.table->contains("assumed")) return;
  std::set<std::string> keys;
  collect_keys(*top.table, "", keys);
  const toml::table* table = top.node("assumed").as_table();
  if (table == nullptr) top.fail("assumed", "must be a table");
  std::vector<std::string> known;
  for (const std::string& key : keys) {
    if (!key.starts_with("assumed")) known.push_back(key);
  }
  const Section s{table, top.file, "assumed"};
  s.accept_only(known);
  for (const auto& [key, value] : *table)
    profile.assumed[std::string(key.str())] = text(s, key.str());
}

}  // namespace

DeviceProfile load_device_profile(const std::filesystem::path& path) {
  const toml::table table = read_toml_file(path);
  const Section top{&table, path.string(), ""};
  top.accept_only(
      {"display_name", "panel", "render_target", "scan_out", "eyes", "lens", "tracker", "assumed"});
  DeviceProfile profile;
  profile.name = path.stem().string();
  profile.display_name = text(top, "display_name");
  read_panel(top, profile);
  const Section eyes = section(top, "eyes", {"left", "right"});
  read_eye(eyes, "left", profile.eyes[0]);
  read_eye(eyes, "right", profile.eyes[1]);
  read_lens(top, profile);
  profile.tracker = read_tracker(top);
  read_assumed(top, profile);
  return profile;
}

}  // namespace brace::sim
