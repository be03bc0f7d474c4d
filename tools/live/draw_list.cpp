#include "tools/live/draw_list.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <imgui.h>

namespace brace {

namespace {

struct Clip {
  int left, top, right, bottom;  // right and bottom are outside
};

/// The first pixel whose centre is not before `edge`.
int first_pixel(float edge) {
  return static_cast<int>(std::ceil(edge - 0.5f));
}

struct Colour {
  std::uint32_t r, g, b, a;
};

Colour colour_of(ImU32 packed) {
  return {packed >> IM_COL32_R_SHIFT & 0xffu, packed >> IM_COL32_G_SHIFT & 0xffu,
          packed >> IM_COL32_B_SHIFT & 0xffu, packed >> IM_COL32_A_SHIFT & 0xffu};
}

std::uint8_t mix(std::uint8_t under, std::uint32_t over, std::uint32_t alpha) {
  return static_cast<std::uint8_t>((over * alpha + under * (255u - alpha) + 127u) / 255u);
}

void blend(Rgba8& pixel, const Colour& colour, std::uint32_t alpha) {
  pixel = {mix(pixel.r, colour.r, alpha), mix(pixel.g, colour.g, alpha), mix(pixel.b, colour.b, alpha), 255};
}

std::uint32_t coverage_at(const CoverageTexture& texture, float u, float v) {
  const int x =
      std::clamp(static_cast<int>(u * static_cast<float>(texture.width_px)), 0, texture.width_px - 1);
  const int y =
      std::clamp(static_cast<int>(v * static_cast<float>(texture.height_px)), 0, texture.height_px - 1);
  return texture.coverage[y * texture.width_px + x];
}

/// Most of an overlay: upright rectangles of one colour, as two triangles.
bool is_rectangle(const std::array<const ImDrawVert*, 6>& v) {
  const ImDrawVert &a = *v[0], &b = *v[1], &c = *v[2], &d = *v[5];
  return v[3] == v[0] && v[4] == v[2] && a.pos.x == d.pos.x && b.pos.x == c.pos.x && a.pos.y == b.pos.y &&
         c.pos.y == d.pos.y && a.pos.x < c.pos.x && a.pos.y < c.pos.y && a.col == b.col && a.col == c.col &&
         a.col == d.col;
}

/// Pixels left .. right - 1 of the rows top .. bottom - 1.
struct Span {
  int left, right, top, bottom;
};

void paint_plain(const Span& span, const Colour& colour, std::uint32_t alpha, ImageRgba8& onto) {
  if (alpha == 0u || span.left >= span.right) return;
  const Rgba8 opaque{static_cast<std::uint8_t>(colour.r), static_cast<std::uint8_t>(colour.g),
                     static_cast<std::uint8_t>(colour.b), 255};
  for (int y = span.top; y < span.bottom; ++y) {
    Rgba8* const row = &onto.at(span.left, y);
    if (alpha == 255u) {
      std::fill_n(row, span.right - span.left, opaque);
    } else {
      for (int x = 0; x < span.right - span.left; ++x)
        blend(row[x], colour, alpha);
    }
  }
}

void paint_rectangle(const ImDrawVert& from, const ImDrawVert& to, const CoverageTexture& texture,
                     const Clip& clip, ImageRgba8& onto) {
  const Span span{std::max(first_pixel(from.pos.x), clip.left), std::min(first_pixel(to.pos.x), clip.right),
                  std::max(first_pixel(from.pos.y), clip.top), std::min(first_pixel(to.pos.y), clip.bottom)};
  const Colour colour = colour_of(from.col);
  if (from.uv.x == to.uv.x && from.uv.y == to.uv.y)
    return paint_plain(span, colour, colour.a * coverage_at(texture, from.uv.x, from.uv.y) / 255u, onto);
  const float u_per_px = (to.uv.x - from.uv.x) / (to.pos.x - from.pos.x);
  const float v_per_px = (to.uv.y - from.uv.y) / (to.pos.y - from.pos.y);
  for (int y = span.top; y < span.bottom; ++y) {
    const float v = from.uv.y + (static_cast<float>(y) + 0.5f - from.pos.y) * v_per_px;
    for (int x = span.left; x < span.right; ++x) {
      const float u = from.uv.x + (static_cast<float>(x) + 0.5f - from.pos.x) * u_per_px;
      const std::uint32_t alpha = colour.a * coverage_at(texture, u, v) / 255u;
      if (alpha != 0u) blend(onto.at(x, y), colour, alpha);
    }
  }
}

/// Twice the area of a, b, p: above 0 where p lies to the right of the edge from a to b, y downwards.
double side(const ImVec2& a, const ImVec2& b, double x, double y) {
  return (static_cast<double>(b.x) - a.x) * (y - a.y) - (static_cast<double>(b.y) - a.y) * (x - a.x);
}

/// Of two triangles at an edge the one below or to the right of it has the pixels on the edge itself.
bool owns_edge(const ImVec2& a, const ImVec2& b) {
  return (a.y == b.y && b.x > a.x) || b.y < a.y;
}

void paint_triangle(const ImDrawVert* a, const ImDrawVert* b, const ImDrawVert* c,
                    const CoverageTexture& texture, const Clip& clip, ImageRgba8& onto) {
  double area = side(a->pos, b->pos, c->pos.x, c->pos.y);
  if (area == 0.0) return;
  if (area < 0.0) {
    std::swap(b, c);
    area = -area;
  }
  const int left = std::max(first_pixel(std::min({a->pos.x, b->pos.x, c->pos.x})), clip.left);
  const int right = std::min(first_pixel(std::max({a->pos.x, b->pos.x, c->pos.x})) + 1, clip.right);
  const int top = std::max(first_pixel(std::min({a->pos.y, b->pos.y, c->pos.y})), clip.top);
  const int bottom = std::min(first_pixel(std::max({a->pos.y, b->pos.y, c->pos.y})) + 1, clip.bottom);
  const bool own_a = owns_edge(b->pos, c->pos), own_b = owns_edge(c->pos, a->pos),
             own_c = owns_edge(a->pos, b->pos);
  const Colour at_a = colour_of(a->col), at_b = colour_of(b->col), at_c = colour_of(c->col);
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double wa = side(b->pos, c->pos, px, py), wb = side(c->pos, a->pos, px, py),
                   wc = side(a->pos, b->pos, px, py);
      if (wa < 0.0 || wb < 0.0 || wc < 0.0) continue;
      if ((wa == 0.0 && !own_a) || (wb == 0.0 && !own_b) || (wc == 0.0 && !own_c)) continue;
      const double fa = wa / area, fb = wb / area, fc = wc / area;
      const auto between = [&](double va, double vb, double vc) { return fa * va + fb * vb + fc * vc; };
      const auto channel = [&](std::uint32_t Colour::*part) {
        return static_cast<std::uint32_t>(between(at_a.*part, at_b.*part, at_c.*part) + 0.5);
      };
      const std::uint32_t covered =
          coverage_at(texture, static_cast<float>(between(a->uv.x, b->uv.x, c->uv.x)),
                      static_cast<float>(between(a->uv.y, b->uv.y, c->uv.y)));
      const std::uint32_t alpha = channel(&Colour::a) * covered / 255u;
      if (alpha != 0u)
        blend(onto.at(x, y), {channel(&Colour::r), channel(&Colour::g), channel(&Colour::b), alpha}, alpha);
    }
}

void paint_command(const ImDrawList& list, const ImDrawCmd& command, const CoverageTexture& texture,
                   const Clip& clip, ImageRgba8& onto) {
  const auto vertex = [&](unsigned int i) {
    const int index = static_cast<int>(command.IdxOffset + i);
    return &list.VtxBuffer[static_cast<int>(command.VtxOffset) + list.IdxBuffer[index]];
  };
  for (unsigned int i = 0; i + 3 <= command.ElemCount;) {
    if (i + 6 <= command.ElemCount) {
      const std::array<const ImDrawVert*, 6> two = {vertex(i),     vertex(i + 1), vertex(i + 2),
                                                    vertex(i + 3), vertex(i + 4), vertex(i + 5)};
      if (is_rectangle(two)) {
        paint_rectangle(*two[0], *two[2], texture, clip, onto);
        i += 6;
        continue;
      }
    }
    paint_triangle(vertex(i), vertex(i + 1), vertex(i + 2), texture, clip, onto);
    i += 3;
  }
}

}  // namespace

void paint(const ImDrawData& drawn, const CoverageTexture& texture, ImageRgba8& onto) {
  for (int n = 0; n < drawn.CmdListsCount; ++n) {
    const ImDrawList& list = *drawn.CmdLists[n];
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.UserCallback != nullptr) continue;
      const Clip clip{std::max(static_cast<int>(command.ClipRect.x - drawn.DisplayPos.x), 0),
                      std::max(static_cast<int>(command.ClipRect.y - drawn.DisplayPos.y), 0),
                      std::min(static_cast<int>(command.ClipRect.z - drawn.DisplayPos.x), onto.width_px),
                      std::min(static_cast<int>(command.ClipRect.w - drawn.DisplayPos.y), onto.height_px)};
      paint_command(list, command, texture, clip, onto);
    }
  }
}

}  // namespace brace
