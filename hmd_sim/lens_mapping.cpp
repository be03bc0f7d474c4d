#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "base/error.hpp"
#include "hmd_sim/lens.hpp"

namespace brace::sim {
namespace {

const LensChannel& channel_of(const EyeLens& lens, Channel channel) {
  return lens.rgb[static_cast<std::size_t>(channel)];
}

// Lens units, y up.
glm::dvec2 display_point(const EyeLens& lens, Channel channel, glm::dvec2 panel_uv) {
  const glm::dvec2 p = (panel_uv - channel_of(lens, channel).centre_uv) * lens.panel_size_units;
  return {p.x, -p.y};
}

glm::dvec2 tangents_of(const EyeLens& lens, Channel channel, glm::dvec2 display) {
  const double scale = lens_scale(lens.kind, channel_of(lens, channel).k, glm::length(display));
  return display * scale * lens.tan_per_unit;
}

bool inside_unit_square(glm::dvec2 uv) {
  return uv.x >= 0.0 && uv.x <= 1.0 && uv.y >= 0.0 && uv.y <= 1.0;
}

glm::dvec2 pixel_centre_uv(int x, int y, glm::ivec2 size_px) {
  return {(x + 0.5) / size_px.x, (y + 0.5) / size_px.y};
}

}  // namespace

double usable_radius(const EyeLens& lens, Channel channel) {
  double corner = 0.0;
  for (const glm::dvec2 uv : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(1, 1)}) {
    corner = std::max(corner, glm::length(display_point(lens, channel, uv)));
  }
  const double limit = std::min(corner, lens.cutoff_radius);
  const double fold = fold_over_radius(lens.kind, channel_of(lens, channel).k, limit);
  // At a fold the slope is 0 and at a pole infinite: stay a hair inside, where the branch is certain.
  return fold < limit ? fold * (1.0 - 1e-9) : limit;
}

std::optional<glm::dvec2> panel_to_tangents(const EyeLens& lens, Channel channel, double usable,
                                            glm::dvec2 panel_uv) {
  const glm::dvec2 p = display_point(lens, channel, panel_uv);
  if (!(glm::length(p) <= usable)) return std::nullopt;
  return tangents_of(lens, channel, p);
}

std::optional<glm::dvec2> panel_to_tangents(const EyeLens& lens, Channel channel, glm::dvec2 panel_uv) {
  return panel_to_tangents(lens, channel, usable_radius(lens, channel), panel_uv);
}

std::optional<glm::dvec2> tangents_to_panel(const EyeLens& lens, Channel channel, double usable,
                                            glm::dvec2 tangents) {
  const glm::dvec2 source = tangents / lens.tan_per_unit;
  const double source_radius = glm::length(source);
  const auto r = lens_inverse(lens.kind, channel_of(lens, channel).k, source_radius, usable);
  if (!r) return std::nullopt;
  const glm::dvec2 p = source_radius > 0.0 ? source * (*r / source_radius) : glm::dvec2(0.0);
  return glm::dvec2(p.x, -p.y) / lens.panel_size_units + channel_of(lens, channel).centre_uv;
}

std::optional<glm::dvec2> tangents_to_panel(const EyeLens& lens, Channel channel, glm::dvec2 tangents) {
  return tangents_to_panel(lens, channel, usable_radius(lens, channel), tangents);
}

glm::dvec2 tangents_to_target_uv(const FovTangents& fov, glm::dvec2 tangents) {
  return {(tangents.x - fov.left) / fov.width(), (fov.top - tangents.y) / fov.height()};
}

glm::dvec2 target_uv_to_tangents(const FovTangents& fov, glm::dvec2 target_uv) {
  return {fov.left + target_uv.x * fov.width(), fov.top - target_uv.y * fov.height()};
}

bool lens_is_identity(const EyeLens& lens, const FovTangents& fov) {
  for (const Channel channel : all_channels) {
    // 5 x 5 points give at least as many different radii as a model has coefficients, so one that is 1 at all
    // of them is 1 everywhere.
    for (int i = 0; i < 25; ++i) {
      const glm::dvec2 uv((i % 5) / 4.0, static_cast<double>(i / 5) / 4.0);
      if (glm::length(display_point(lens, channel, uv)) > lens.cutoff_radius) return false;
      const glm::dvec2 tangents = tangents_of(lens, channel, display_point(lens, channel, uv));
      if (!(glm::length(tangents_to_target_uv(fov, tangents) - uv) <= 1e-9)) return false;
    }
  }
  return true;
}

bool lens_channels_equal(const EyeLens& lens) {
  for (const LensChannel& channel : lens.rgb) {
    if (channel.k != lens.rgb[0].k || channel.centre_uv != lens.rgb[0].centre_uv) return false;
  }
  return true;
}

namespace {

// The four target pixels that a bilinear read at `uv` touches (clamped to the edge) are seen.
void mark_bilinear_taps(Image<std::uint8_t>& hidden, glm::dvec2 uv) {
  const int x0 = static_cast<int>(std::floor(uv.x * hidden.width_px - 0.5));
  const int y0 = static_cast<int>(std::floor(uv.y * hidden.height_px - 0.5));
  for (int y = y0; y <= y0 + 1; ++y) {
    for (int x = x0; x <= x0 + 1; ++x) {
      hidden.at(std::clamp(x, 0, hidden.width_px - 1), std::clamp(y, 0, hidden.height_px - 1)) = 0;
    }
  }
}

// A target pixel whose centre lands on the panel is seen, and so are its neighbours, which a read near it
// touches.
void mark_pixel_and_neighbours(Image<std::uint8_t>& hidden, int x, int y) {
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, hidden.height_px - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, hidden.width_px - 1); ++u)
      hidden.at(u, v) = 0;
  }
}

}  // namespace

HiddenAreaMask hidden_area_mask(const EyeLens& lens, const FovTangents& fov, glm::ivec2 panel_size_px,
                                glm::ivec2 target_size_px) {
  BRACE_CHECK(panel_size_px.x > 0 && panel_size_px.y > 0 && target_size_px.x > 0 && target_size_px.y > 0);
  HiddenAreaMask mask{{panel_size_px.x, panel_size_px.y}, {target_size_px.x, target_size_px.y}};
  std::fill(mask.panel.pixels.begin(), mask.panel.pixels.end(), std::uint8_t{1});
  std::fill(mask.source.pixels.begin(), mask.source.pixels.end(), std::uint8_t{1});
  for (const Channel channel : all_channels) {
    if (channel != Channel::red && lens_channels_equal(lens)) break;
    const double usable = usable_radius(lens, channel);
    for (int y = 0; y < panel_size_px.y; ++y) {
      for (int x = 0; x < panel_size_px.x; ++x) {
        const auto tangents = panel_to_tangents(lens, channel, usable, pixel_centre_uv(x, y, panel_size_px));
        if (!tangents) continue;
        const glm::dvec2 uv = tangents_to_target_uv(fov, *tangents);
        if (!inside_unit_square(uv)) continue;
        mask.panel.at(x, y) = 0;
        mark_bilinear_taps(mask.source, uv);
      }
    }
    for (int y = 0; y < target_size_px.y; ++y) {
      for (int x = 0; x < target_size_px.x; ++x) {
        const glm::dvec2 tangents = target_uv_to_tangents(fov, pixel_centre_uv(x, y, target_size_px));
        const auto uv = tangents_to_panel(lens, channel, usable, tangents);
        if (uv && inside_unit_square(*uv)) mark_pixel_and_neighbours(mask.source, x, y);
      }
    }
  }
  return mask;
}

DistortionMesh distortion_mesh(const EyeLens& lens, const FovTangents& fov, int columns, int rows) {
  BRACE_CHECK(columns > 0 && rows > 0);
  std::array<double, 3> usable{};
  for (const Channel channel : all_channels) {
    usable[static_cast<std::size_t>(channel)] = usable_radius(lens, channel);
  }
  DistortionMesh mesh{columns, rows, {}};
  mesh.vertices.reserve(static_cast<std::size_t>(columns + 1) * static_cast<std::size_t>(rows + 1));
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      DistortionVertex vertex;
      vertex.panel_uv = {static_cast<double>(column) / columns, static_cast<double>(row) / rows};
      vertex.visible = true;
      for (const Channel channel : all_channels) {
        const auto c = static_cast<std::size_t>(channel);
        glm::dvec2 p = display_point(lens, channel, vertex.panel_uv);
        const double r = glm::length(p);
        if (r > usable[c]) {
          p *= usable[c] / r;
          vertex.visible = false;
        }
        vertex.tangents[c] = tangents_of(lens, channel, p);
        if (!inside_unit_square(tangents_to_target_uv(fov, vertex.tangents[c]))) vertex.visible = false;
      }
      mesh.vertices.push_back(vertex);
    }
  }
  return mesh;
}

}  // namespace brace::sim
