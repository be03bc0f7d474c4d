#include "tools/live/overlay.hpp"

#include <gtest/gtest.h>
#include <imgui.h>

#include "tools/live/overlay_figures.hpp"

namespace brace {
namespace {

constexpr Rgba8 under{10, 20, 30, 255};

ImageRgba8 plain(int width_px, int height_px) {
  ImageRgba8 image(width_px, height_px);
  for (Rgba8& pixel : image.pixels)
    pixel = under;
  return image;
}

/// What a list of shapes gives on a picture of 40 x 30 pixels; `draw` puts the shapes in.
template <class Draw>
ImageRgba8 painted(const Draw& draw, const ImVec4& clip = ImVec4(0, 0, 40, 30)) {
  Overlay overlay;
  ImageRgba8 picture = plain(40, 30);
  overlay.begin(40, 30, 0.1);
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  list.PushClipRect(ImVec2(clip.x, clip.y), ImVec2(clip.z, clip.w));
  list.Flags = ImDrawListFlags_None;
  draw(list);
  list.PopClipRect();
  overlay.end(picture);
  return picture;
}

int count_not(const ImageRgba8& picture, Rgba8 colour) {
  int count = 0;
  for (const Rgba8& pixel : picture.pixels)
    count += !(pixel == colour);
  return count;
}

TEST(Paint, FillsThePixelsWhoseCentresAreInside) {
  const ImageRgba8 picture = painted(
      [](ImDrawList& list) { list.AddRectFilled(ImVec2(3.4f, 5.6f), ImVec2(10.5f, 8.4f), IM_COL32_WHITE); });
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool inside = x >= 3 && x <= 9 && y >= 6 && y <= 7;
      EXPECT_EQ(picture.at(x, y), (inside ? Rgba8{255, 255, 255, 255} : under)) << x << ' ' << y;
    }
}

TEST(Paint, BlendsByAlpha) {
  const ImageRgba8 picture = painted([](ImDrawList& list) {
    list.AddRectFilled(ImVec2(0, 0), ImVec2(40, 30), IM_COL32(200, 100, 0, 51));  // a fifth
  });
  EXPECT_EQ(picture.at(7, 9), (Rgba8{48, 36, 24, 255}));
}

TEST(Paint, GivesEveryPixelOfAFanToOneTriangle) {
  // Half transparent: a pixel painted twice, or not at all, shows. The corner in the middle is no pixel's.
  const ImageRgba8 picture = painted([](ImDrawList& list) {
    const ImVec2 corners[] = {{4, 3}, {21, 2}, {36, 9}, {35, 26}, {15, 28}, {2, 17}};
    const ImVec2 middle(17.5f, 14.5f);  // a pixel's centre
    for (int i = 0; i < 6; ++i)
      list.AddTriangleFilled(middle, corners[i], corners[(i + 1) % 6], IM_COL32(255, 255, 255, 128));
  });
  const ImageRgba8 once = painted([](ImDrawList& list) {
    list.AddRectFilled(ImVec2(0, 0), ImVec2(40, 30), IM_COL32(255, 255, 255, 128));
  });
  int inside = 0;
  for (const Rgba8& pixel : picture.pixels) {
    if (pixel == under) continue;
    EXPECT_EQ(pixel, once.at(0, 0));
    ++inside;
  }
  // Shoelace: the polygon's area.
  EXPECT_NEAR(inside, 705.0, 10.0);
  EXPECT_EQ(picture.at(17, 14), once.at(0, 0));
}

TEST(Paint, DoesNotMindTheTrianglesTurn) {
  const auto triangle = [](ImVec2 a, ImVec2 b, ImVec2 c) {
    return painted([=](ImDrawList& list) { list.AddTriangleFilled(a, b, c, IM_COL32_WHITE); });
  };
  const ImVec2 a(3, 4), b(30, 8), c(12, 27);
  EXPECT_EQ(triangle(a, b, c).pixels, triangle(a, c, b).pixels);
  EXPECT_GT(count_not(triangle(a, b, c), under), 200);
}

TEST(Paint, InterpolatesColours) {
  const ImageRgba8 picture = painted([](ImDrawList& list) {
    list.AddRectFilledMultiColor(ImVec2(0, 0), ImVec2(40, 30), IM_COL32(0, 0, 0, 255),
                                 IM_COL32(200, 0, 0, 255), IM_COL32(200, 0, 0, 255), IM_COL32(0, 0, 0, 255));
  });
  for (int x = 0; x < 40; ++x)
    EXPECT_NEAR(picture.at(x, 11).r, 200.0 * (x + 0.5) / 40.0, 1.0);
}

TEST(Paint, StaysInsideTheClipAndThePicture) {
  const auto shapes = [](ImDrawList& list) {
    list.AddRectFilled(ImVec2(-1e4f, -1e4f), ImVec2(1e4f, 1e4f), IM_COL32_WHITE);
    list.AddTriangleFilled(ImVec2(-1e4f, -1e4f), ImVec2(1e4f, 0), ImVec2(0, 1e4f), IM_COL32_WHITE);
  };
  EXPECT_EQ(count_not(painted(shapes, ImVec4(5, 6, 11, 10)), under), 6 * 4);
  EXPECT_EQ(count_not(painted(shapes), under), 40 * 30);
}

/// A frame of the figures in a window.
struct Shown {
  ImageRgba8 picture;
  WidgetPlaces places;
};
Shown show_figures(const OverlayFacts& facts, const FrameHistory& history) {
  Overlay overlay;
  Shown shown{plain(900, 600), {}};
  for (int i = 0; i < 2; ++i) {  // Dear ImGui knows sizes from the second frame on
    shown.picture = plain(900, 600);
    const WindowLayout layout = lay_out(900, 600, true);
    overlay.begin(900, 600, 0.01);
    if (overlay.begin_panel("column", layout.column)) {
      facts_panel(facts, history);
      figures_panel(overlay, facts, history);
    }
    overlay.end_panel();
    timeline_panel(overlay, facts, history, layout.strip);
    overlay.end(shown.picture);
  }
  shown.places = overlay.places();
  return shown;
}

FrameHistory steady_history(double missed_at_s) {
  FrameHistory history;
  for (int i = 0; i < 360; ++i) {
    LiveFrame frame;
    frame.shown = SimTime(from_s(i / 90.0));
    frame.interval_ms = 1e3 / 90.0;
    frame.missed = i / 90.0 == missed_at_s ? 1 : 0;
    if (frame.missed > 0) frame.interval_ms *= 2.0;
    history.add(frame);
  }
  return history;
}

int reddish(const ImageRgba8& picture, const WindowRect& rect) {
  int count = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      const Rgba8 pixel = picture.at(x, y);
      count += pixel.r > 200 && pixel.g < 100 && pixel.b < 100;
    }
  return count;
}

TEST(Figures, LeaveTheEyesAlone) {
  const Shown shown = show_figures({}, steady_history(-1));
  const WindowRect eyes = lay_out(900, 600, true).eyes;
  for (int y = 0; y < eyes.height; ++y)
    for (int x = 0; x < eyes.width; ++x)
      ASSERT_EQ(shown.picture.at(x, y), under) << x << ' ' << y;
  EXPECT_NE(shown.picture.at(880, 20), under);
}

TEST(Figures, MarkMissedVsyncsInTheTimeline) {
  const WindowRect strip = lay_out(900, 600, true).strip;
  EXPECT_EQ(reddish(show_figures({}, steady_history(-1)).picture, strip), 0);
  EXPECT_GT(reddish(show_figures({}, steady_history(2.0)).picture, strip), 20);
}

TEST(Figures, ShowAFaultInRed) {
  OverlayFacts facts;
  EXPECT_FALSE(show_figures(facts, {}).places.contains("fault"));
  facts.fault = "mine/mine.glsl:12: error: 'nothing' : undeclared identifier";
  const Shown shown = show_figures(facts, {});
  ASSERT_TRUE(shown.places.contains("fault"));
  EXPECT_GT(reddish(shown.picture, shown.places.at("fault")), 100);
}

}  // namespace
}  // namespace brace
