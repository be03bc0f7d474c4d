#include "runtime/mab/mab_plan.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/error.hpp"
#include "hmd_sim/gaze.hpp"
#include "hmd_sim/pose_trace.hpp"

namespace brace {

namespace {

constexpr int texels_max = 16383;  // pack_texel

void read_scales(const PipelineStage& stage, MabSettings& settings) {
  for (int i = 0; i < settings.levels; ++i) {
    const auto level = static_cast<std::size_t>(i);
    settings.scale[level] = stage.value(fmt::format("scale_{}", i));
    if (i > 0 && !(settings.scale[level] < settings.scale[level - 1])) {
      throw input_error("stage rays/mab: scale_{} = {} is not below scale_{} = {}; accepted: falling scales",
                        i, settings.scale[level], i - 1, settings.scale[level - 1]);
    }
  }
}

/// By radius, where the settings say; by demand, begin_where_enough.
void read_anchors(const PipelineStage& stage, MabSettings& settings) {
  settings.anchors.levels = settings.levels;
  settings.anchors.blend = stage.value("blend");
  for (int i = 1; i < settings.levels; ++i) {
    const auto level = static_cast<std::size_t>(i);
    settings.anchors.begin[level] = stage.value(fmt::format("anchor_{}", i));
    if (i > 1 && !(settings.anchors.begin[level] >= settings.anchors.begin[level - 1])) {
      throw input_error("stage rays/mab: anchor_{} = {} is below anchor_{} = {}; accepted: rising anchors", i,
                        settings.anchors.begin[level], i - 1, settings.anchors.begin[level - 1]);
    }
  }
}

/// A level begins where its scale is enough for the demand.
void begin_where_enough(LevelAnchors& anchors, const MabSettings& settings,
                        const LevelCoordinates& coordinates) {
  anchors.limited = true;
  for (int i = 1; i < settings.levels; ++i) {
    const auto level = static_cast<std::size_t>(i);
    anchors.limit[level] = anchors.begin[level];
    // At an entry of the table of weights: linear in between, a level would reach in before its begin.
    const double entries = mab_weight_entries - 1;
    anchors.begin[level] = std::ceil(coordinates.coordinate_of(settings.scale[level]) * entries) / entries;
  }
}

std::vector<AtlasRect> level_sizes(const MabSettings& settings, glm::ivec2 eye_px) {
  std::vector<AtlasRect> sizes;
  for (int i = 0; i < settings.levels; ++i) {
    const double scale = settings.scale[static_cast<std::size_t>(i)];
    sizes.push_back({0, 0, std::max(1, static_cast<int>(std::lround(eye_px.x * scale))),
                     std::max(1, static_cast<int>(std::lround(eye_px.y * scale)))});
  }
  return sizes;
}

std::uint64_t area(int width, int height) {
  return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
}

/// A direction of the head frame as tangents of an eye's, whose display may be canted.
glm::dvec2 gaze_of_eye(const sim::EyeProfile& eye, const glm::dvec3& gaze) {
  return sim::gaze_tangents(glm::conjugate(eye.head_from_eye.orientation) * gaze);
}

}  // namespace

MabSettings mab_settings(const PipelineStage& stage) {
  MabSettings settings;
  settings.map = static_cast<LevelMap>(static_cast<int>(stage.value("map")));
  settings.levels = static_cast<int>(stage.value("levels"));
  read_scales(stage, settings);
  read_anchors(stage, settings);
  settings.gaze_tan = {stage.value("gaze_x"), stage.value("gaze_y")};
  settings.acuity_slope = stage.value("acuity_slope");
  settings.reach = stage.value("filter") == 0.0 ? 1 : 2;
  settings.compact = stage.value("scheme") == 0.0;
  settings.ray_share = stage.value("ray_share");
  settings.gaze = static_cast<MabGaze>(static_cast<int>(stage.value("gaze")));
  return settings;
}

MabPlan::MabPlan(const MabSettings& settings, const sim::DeviceProfile& profile, const Sizes& sizes)
    : settings_(settings),
      optics_(profile.eyes),
      sizes_(sizes),
      eye_px_(sizes.eye_px),
      atlas_(pack_atlas(level_sizes(settings, sizes.eye_px))) {
  if (std::max(atlas_.width, atlas_.height) > texels_max) {
    throw input_error("stage rays/mab: the atlas is {} x {} texels; accepted: up to {} across and down",
                      atlas_.width, atlas_.height, texels_max);
  }
  for (const sim::Eye eye : sim::all_eyes) {
    gaze_tan_[index(eye)] = settings.gaze == MabGaze::fixed
                                ? settings.gaze_tan
                                : gaze_of_eye(optics_[index(eye)], sim::straight_ahead);
  }
  lay_levels();
}

void MabPlan::lay_levels() {
  eyes_.clear();
  rays_.assign(static_cast<std::size_t>(steps()) + 1, 0);
  for (const sim::Eye eye : sim::all_eyes) {
    const sim::EyeProfile& optics = optics_[index(eye)];
    LevelMapInput input{.lens = optics.lens,
                        .fov = optics.fov,
                        .width_px = eye_px_.x,
                        .height_px = eye_px_.y,
                        .panel_width_px = sizes_.panel_px.x,
                        .panel_height_px = sizes_.panel_px.y,
                        .gaze_tan = gaze_tan_[index(eye)],
                        .acuity_slope = settings_.acuity_slope,
                        .demand_min = 0.5 * settings_.scale[static_cast<std::size_t>(settings_.levels - 1)],
                        .resolution_scale = sizes_.resolution_scale};
    input.demand_cap = settings_.scale[0];
    if (settings_.gaze != MabGaze::fixed || settings_.map != LevelMap::radius)
      input.reach_tan = gaze_of_eye(optics, sim::straight_ahead);
    LevelCoordinates coordinates = level_coordinates(settings_.map, input);
    LiveTexels texels(atlas_.levels, {eye_px_.x, eye_px_.y, coordinates.x}, settings_.reach);
    LevelAnchors anchors = settings_.anchors;
    if (settings_.map != LevelMap::radius) begin_where_enough(anchors, settings_, coordinates);
    eyes_.push_back({std::move(coordinates.x), std::move(texels), anchors});
  }
  eye_rays_max_ = 0;
  for (int step = 0; step <= steps(); ++step) {
    for (const sim::Eye which : sim::all_eyes) {
      const std::uint64_t live = eyes_[index(which)].texels.count(weights(which, step));
      rays_[static_cast<std::size_t>(step)] += live;
      eye_rays_max_ = std::max(eye_rays_max_, live);
    }
  }
  const double rays_max = settings_.ray_share * 2.0 * static_cast<double>(area(eye_px_.x, eye_px_.y));
  share_limit_ = std::min(1.0, rays_max / static_cast<double>(rays(steps())));
}

bool MabPlan::look_at(const glm::dvec3& gaze) {
  if (settings_.gaze == MabGaze::fixed || settings_.map == LevelMap::lens) return false;
  bool moved = false;
  std::array<glm::dvec2, 2> gaze_tan{};
  for (const sim::Eye eye : sim::all_eyes) {
    const sim::EyeProfile& optics = optics_[index(eye)];
    gaze_tan[index(eye)] = gaze_of_eye(optics, gaze);
    const glm::dvec2 px = (gaze_tan[index(eye)] - gaze_tan_[index(eye)]) * glm::dvec2(eye_px_) /
                          glm::dvec2(optics.fov.width(), optics.fov.height());
    moved = moved || !(glm::length(px) < 0.25);
  }
  if (!moved) return false;
  gaze_tan_ = gaze_tan;
  lay_levels();
  return true;
}

LevelWeights MabPlan::weights(sim::Eye eye, int step) const {
  return level_weights(moved(eyes_[index(eye)].anchors, static_cast<double>(step) / steps()));
}

int MabPlan::step_for(double quality) const {
  const double allowed = quality * static_cast<double>(rays(steps())) * (1.0 + 1e-12);
  int best = 0;
  for (int step = 0; step <= steps(); ++step) {
    const std::uint64_t there = rays(step), found = rays(best);
    const bool fits = static_cast<double>(there) <= allowed;
    const bool found_fits = static_cast<double>(found) <= allowed;
    if (fits ? !found_fits || there >= found : !found_fits && there < found) best = step;
  }
  return best;
}

double MabPlan::quality_min() const {
  return static_cast<double>(*std::min_element(rays_.begin(), rays_.end())) /
         static_cast<double>(rays(steps()));
}

MabRays MabPlan::make_rays(sim::Eye eye, int step) const {
  const LiveTexels& texels = eyes_[index(eye)].texels;
  return settings_.compact ? texels.compact(weights(eye, step)) : texels.discard(weights(eye, step), atlas_);
}

std::uint64_t MabPlan::capacity() const {
  if (!settings_.compact) return area(atlas_.width, atlas_.height);
  // A grid of groups, its last row filled up. Where a gaze moves to is not known: then for every texel.
  std::uint64_t rays_max = eye_rays_max_;
  if (settings_.gaze != MabGaze::fixed) {
    rays_max = 0;
    for (const AtlasRect& level : atlas_.levels)
      rays_max += area(level.width, level.height);
  }
  const std::uint64_t groups = (rays_max + 63) / 64;
  const auto across = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(groups))));
  return 64 * (across + 1) * (across + 1);
}

std::string MabPlan::summary() const {
  std::uint64_t used = 0;
  std::string sizes;
  for (const AtlasRect& level : atlas_.levels) {
    used += area(level.width, level.height);
    sizes += fmt::format("{}{} x {}", sizes.empty() ? "" : ", ", level.width, level.height);
  }
  const std::uint64_t atlas = area(atlas_.width, atlas_.height);
  return fmt::format(
      "levels of {} in an atlas of {} x {} ({:.1f} % of it used); {} rays for the {} pixels of both eyes "
      "({:.1f} %), down to {:.1f} % by load control{}",
      sizes, atlas_.width, atlas_.height, 100.0 * static_cast<double>(used) / static_cast<double>(atlas),
      rays(step_asked(1.0)), 2 * area(eye_px_.x, eye_px_.y),
      50.0 * static_cast<double>(rays(step_asked(1.0))) / static_cast<double>(area(eye_px_.x, eye_px_.y)),
      50.0 * quality_min() * static_cast<double>(rays(steps())) /
          static_cast<double>(area(eye_px_.x, eye_px_.y)),
      settings_.gaze == MabGaze::fixed ? "" : "; while the gaze is straight ahead");
}

}  // namespace brace
