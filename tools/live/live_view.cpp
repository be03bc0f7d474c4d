#include "tools/live/live_view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/error.hpp"
#include "runtime/metrics/image_error.hpp"

namespace brace {

namespace {

[[noreturn]] void no_view(ViewKind kind, const std::string& why, const char* accepted) {
  throw input_error("no view '{}': {}; accepted: {}", name_of(kind), why, accepted);
}

void require_counts(const Session& session, const SceneOnDevice& scene, ViewKind kind) {
  const StageInfo& cast = session.pipeline.at("cast").stage;
  if (cast.native != nullptr)
    no_view(kind, cast.id() + " does not tell the work of single rays", "cast stages in GLSL");
  if (kind == ViewKind::skip_steps && scene.skip_stage.stage.name == "none")
    no_view(kind, "the session skips nothing", "pipeline.skip other than none");
}

void put_grey(const gpu::Device& device, const EyeTarget& into, const std::vector<std::uint8_t>& greys) {
  std::vector<std::uint32_t> packed(greys.size());
  std::transform(greys.begin(), greys.end(), packed.begin(),
                 [](std::uint8_t grey) { return 0xff000000u | std::uint32_t{grey} * 0x010101u; });
  gpu::upload_values<std::uint32_t>(device, into.image, packed);
}

/// The level with the largest share at every pixel.
std::vector<std::uint8_t> level_greys(const MabPlan& plan, sim::Eye eye) {
  const LevelWeights weights = plan.weights(eye, plan.steps());
  std::array<std::uint8_t, mab_weight_entries> of_entry{};
  for (std::size_t entry = 0; entry < of_entry.size(); ++entry) {
    int largest = 0;
    const auto share = [&](int level) {
      return weights.entries[static_cast<std::size_t>(level) * mab_weight_entries + entry];
    };
    for (int level = 1; level < weights.levels; ++level)
      if (share(level) > share(largest)) largest = level;
    of_entry[entry] = static_cast<std::uint8_t>(1 + level_grey_step * largest);
  }
  std::vector<std::uint8_t> greys;
  for (const float coordinate : plan.coordinates(eye))
    greys.push_back(of_entry[static_cast<std::size_t>(std::lround(coordinate * (mab_weight_entries - 1)))]);
  return greys;
}

EyeRenderer::RayHeat heat_of(ViewKind kind) {
  return kind == ViewKind::samples ? EyeRenderer::RayHeat::samples : EyeRenderer::RayHeat::skip_steps;
}

}  // namespace

LiveView::LiveView(const Inputs& inputs, ViewKind kind)
    : in_(inputs),
      kind_(kind),
      plain_(inputs.device, inputs.headset, inputs.options.no_warp, inputs.options.data_folder) {
  switch (kind) {
    case ViewKind::picture:
      break;
    case ViewKind::difference:
    case ViewKind::dssim:
      ideal_.emplace(in_.device, in_.session, in_.headset, in_.scene, in_.placement, in_.options);
      for (const sim::Eye eye : sim::all_eyes)
        visible_[static_cast<std::size_t>(eye)] = visible_pixels(in_.headset, eye);
      break;
    case ViewKind::levels:
      make_levels();
      break;
    case ViewKind::skip_steps:
    case ViewKind::samples:
      require_counts(in_.session, in_.scene, kind);
      heat_.emplace(in_.device, in_.session, in_.headset, in_.scene, in_.placement, in_.options.data_folder,
                    EyeRenderer::Counting::on, nullptr, EyeRenderer::SecondEye::ray_cast,
                    EyeRenderer::Layers::none, heat_of(kind));
      legend_ = {kind == ViewKind::samples ? "samples of each ray, by their logarithm"
                                           : "skip steps of each ray, by their logarithm",
                 "0", "1023 and more"};
      break;
    case ViewKind::depth:
      own_eyes_ = make_eye_pair(in_.device, in_.headset.eye);
      break;
  }
}

void LiveView::make_levels() {
  const std::optional<MabPlan> plan = plan_mab(in_.session, in_.headset);
  if (!plan) {
    no_view(ViewKind::levels, in_.session.pipeline.at("rays").stage.id() + " has no levels",
            "pipeline.rays = mab");
  }
  const EyePair eyes = make_eye_pair(in_.device, in_.headset.eye);
  for (const sim::Eye eye : sim::all_eyes)
    put_grey(in_.device, eyes[static_cast<std::size_t>(eye)], level_greys(*plan, eye));
  plain_.show({eyes});
  levels_ = plain_.read();
  legend_.words = "levels of rays/mab; each pixel by the one with the largest share";
  const int levels = plan->weights(sim::Eye::left, plan->steps()).levels;
  for (int level = 0; level < levels; ++level)
    legend_.swatches.emplace_back(level_colour(level), fmt::format("{}", level));
}

PanelPair LiveView::compare(const PanelPair& shown, const Pose& warp_world_from_head) {
  const PanelPair reference = ideal_->show(TruePose{warp_world_from_head});
  std::array<ImageError, 2> errors;
  PanelPair made;
  for (std::size_t i = 0; i < 2; ++i) {
    errors[i] = image_error(shown[i], reference[i], visible_[i]);
    made[i] = kind_ == ViewKind::dssim ? dssim_picture(shown[i], reference[i])
                                       : difference_picture(shown[i], reference[i]);
  }
  legend_.words = fmt::format(
      "from the ideal picture: DSSIM {:.2g} left, {:.2g} right; largest difference {:.3f} of full scale",
      errors[0].dssim, errors[1].dssim, std::max(errors[0].max_error, errors[1].max_error));
  legend_.low = "0 (equal: black)";
  legend_.high = kind_ == ViewKind::dssim ? fmt::format("DSSIM {:g}", dssim_shown_max)
                                          : fmt::format("{:g}", difference_shown_max);
  return made;
}

void LiveView::put_depths(const EyePair& eyes, const Pose& world_from_head) {
  // The distances that the volume's bounding sphere has, of both eyes.
  const VolumeInfo& info = in_.scene.volume.info();
  const auto edges = box_size(info);
  const double largest = *std::max_element(edges.begin(), edges.end());
  const double radius_m =
      0.5 * in_.placement.size_m * std::hypot(edges[0] / largest, edges[1] / largest, edges[2] / largest);
  const double away_m = glm::length(in_.placement.world_from_volume.position - world_from_head.position);
  const double near_m = std::max(away_m - radius_m, 0.0), far_m = away_m + radius_m;
  for (std::size_t i = 0; i < 2; ++i) {
    std::vector<float> depths_m(static_cast<std::size_t>(eyes[i].width_px) *
                                static_cast<std::size_t>(eyes[i].height_px));
    gpu::download_values<float>(in_.device, eyes[i].depth, depths_m);
    std::vector<std::uint8_t> greys(depths_m.size());
    std::transform(depths_m.begin(), depths_m.end(), greys.begin(), [&](float depth_m) {
      return std::isfinite(depth_m) ? grey_of((far_m - depth_m) / (far_m - near_m)) : std::uint8_t{0};
    });
    put_grey(in_.device, (*own_eyes_)[i], greys);
  }
  legend_ = {"first visible sample of each ray", fmt::format("{:.2f} m", far_m),
             fmt::format("{:.2f} m", near_m)};
}

PanelPair LiveView::scalar(const EyePair& eyes, const Pose& world_from_head) {
  plain_.show({eyes, world_from_head, world_from_head});
  const PanelPair greys = plain_.read();
  return {coloured(greys[0]), coloured(greys[1])};
}

PanelPair LiveView::make(const PanelPair& shown, const EyePair& eyes, const Pose& render_world_from_head,
                         const Pose& warp_world_from_head) {
  switch (kind_) {
    case ViewKind::picture:
      break;
    case ViewKind::difference:
    case ViewKind::dssim:
      return compare(shown, warp_world_from_head);
    case ViewKind::levels:
      return {tinted_by_level(shown[0], levels_[0]), tinted_by_level(shown[1], levels_[1])};
    case ViewKind::skip_steps:
    case ViewKind::samples:
      return scalar(eyes, render_world_from_head);
    case ViewKind::depth:
      put_depths(eyes, render_world_from_head);
      return scalar(*own_eyes_, render_world_from_head);
  }
  return shown;
}

}  // namespace brace
