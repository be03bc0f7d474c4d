// Every stereo stage with every rays stage, schedule, skip structure and warp, at a small size: a combination
// shows what two passes show, within its bound, or is refused by a message that names both stages.
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include <gmock/gmock.h>

#include "runtime/metrics/image_error.hpp"
#include "runtime/replay/eye_renderer.hpp"
#include "runtime/replay/panel_display.hpp"
#include "runtime/replay/scene_activation.hpp"
#include "tests/unit/gpu/gpu_fixture.hpp"
#include "tests/unit/stereo_matrix/stereo_session.hpp"

namespace brace {
namespace {

using namespace test;

// Against two passes with the same rays; the left eye is theirs bit for bit. A picture of 24 px has coarse
// samples.
constexpr double kRightDssimMax = 0.03;
constexpr double kVolumetricDssimMax = 0.01;  // layers stand for a ray's samples
constexpr double kCoarseDssimMax = 0.05;      // … and with rays/mab one ray's for several pixels
constexpr int kCells = 3;                     // across and down

struct Combination {
  std::string stereo, rays, skip, schedule, warp;
};

std::string text(const Combination& c) {
  return "stereo/" + c.stereo + " rays/" + c.rays + " skip/" + c.skip + " schedule/" + c.schedule + " warp/" +
         c.warp;
}

Session session_of(const Combination& c) {
  return stereo_session(
      {{"rays", c.rays}, {"skip", c.skip}, {"stereo", c.stereo}, {"schedule", c.schedule}, {"warp", c.warp}});
}

const Headset& headset() {
  static const Headset made =
      make_headset(session_of({"two_pass", "full_rate", "none", "whole_frame", "none"}).device, data);
  return made;
}

constexpr std::array<double, 3> kTurns_rad = {0.0, 0.12, -0.1};

Pose head(double turn_rad) {
  Pose pose;
  pose.orientation = quat_exp({0.0, turn_rad, 0.0});
  pose.position = {0.1 * turn_rad, 0.0, 0.0};
  return pose;
}

/// Both eyes from three heads.
using Pictures = std::vector<std::array<ImageRgba8, 2>>;

/// What a session's eye frames come from. Throws input_error where its stages do not work together.
class Rig {
 public:
  Rig(const gpu::Device& device, const Combination& c)
      : device_(device),
        session_(session_of(c)),
        headset_(headset()),
        placement_(place_volume(session_.scene, Pose{})),
        eyes_(make_eye_pair(device, session_, headset_)),
        scene_(load_scene(device, session_, {.data_folder = data}, headset_, placement_)),
        renderer_(device, session_, headset_, *scene_, placement_, data, EyeRenderer::Counting::on, nullptr,
                  EyeRenderer::SecondEye::as_session, EyeRenderer::Layers::as_session) {}

  Pictures frames(bool in_cells) {
    Pictures all;
    for (const double turn : kTurns_rad) {
      if (in_cells) {
        const JobOutcome outcome = renderer_.render_cells(head(turn), eyes_, 1.0, {kCells, kCells});
        EXPECT_EQ(outcome.cells.size(), 2u * kCells * kCells);
      } else {
        renderer_.render(head(turn), eyes_);
      }
      all.push_back({picture(0), picture(1)});
    }
    return all;
  }

  /// The panels after a warp to the pose of the last frame.
  PanelPair panels(PanelDisplay& display) {
    display.show({eyes_, head(kTurns_rad.back()), head(kTurns_rad.back())});
    return display.read();
  }

  /// Outlives this.
  std::unique_ptr<PanelDisplay> display(const std::string& warp) {
    return std::make_unique<PanelDisplay>(
        device_, headset_, stage_named("warp", warp), stage_named("warp", "none"),
        scene_activation(device_, session_, headset_, *scene_, placement_), data);
  }

 private:
  ImageRgba8 picture(std::size_t eye) const {
    ImageRgba8 image(headset_.eye.width_px, headset_.eye.height_px);
    gpu::download_values<Rgba8>(device_, eyes_[eye].image, image.pixels);
    return image;
  }

  const gpu::Device& device_;
  Session session_;
  const Headset& headset_;
  VolumePlacement placement_;
  EyePair eyes_;
  std::unique_ptr<SceneOnDevice> scene_;
  EyeRenderer renderer_;
};

bool same(const ImageRgba8& a, const ImageRgba8& b) {
  return a.pixels == b.pixels;
}

double dssim(const ImageRgba8& a, const ImageRgba8& b) {
  return dssim_from_ssim(ssim(a, b));
}

class StereoMatrix : public gpu::GpuTest {
 protected:
  /// The message names two stages of the combination.
  void expect_refused_by_name(const Combination& c, const std::string& message) {
    int named = 0;
    for (const std::string& id : {"stereo/" + c.stereo, "rays/" + c.rays, "skip/" + c.skip,
                                  "schedule/" + c.schedule, "warp/" + c.warp})
      named += message.find(id) != std::string::npos;
    EXPECT_GE(named, 2) << text(c) << ": " << message;
    ++refused_[c.stereo];
  }

  /// Warps of one kind, layered or not, over one renderer; both schedules.
  void try_renderer(Combination c, const std::vector<std::string>& warps) {
    c.warp = warps.front();
    std::optional<Rig> rig;
    std::string why;
    try {
      rig.emplace(device(), c);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input) << text(c);
      why = error.what();
    }
    for (const char* schedule : {"whole_frame", "chunked"}) {
      c.schedule = schedule;
      if (rig) why = c.schedule == "chunked" ? cells_refused(c) : "";
      if (!why.empty()) {
        for (const std::string& warp : warps) {
          c.warp = warp;
          expect_refused_by_name(c, why);
        }
        continue;
      }
      expect_like_two_passes(c, rig->frames(c.schedule == "chunked"));
      for (const std::string& warp : warps) {
        c.warp = warp;
        expect_shown(c, *rig);
        ++done_[c.stereo];
      }
    }
  }

  std::string cells_refused(const Combination& c) {
    try {
      require_cells(session_of(c));
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  }

  /// Neither skipping nor cells change a bit; the left eye is that of two passes.
  void expect_like_two_passes(const Combination& c, const Pictures& frames) {
    if (c.stereo == "two_pass" && two_passes_.count(c.rays) == 0) two_passes_[c.rays] = frames;
    const Pictures& two = two_passes_.at(c.rays);
    const Pictures& first = first_.emplace(c.stereo + c.rays, frames).first->second;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_TRUE(same(frames[i][0], two[i][0])) << text(c) << ", left eye of frame " << i;
      EXPECT_TRUE(same(frames[i][1], first[i][1])) << text(c) << ", right eye of frame " << i;
      EXPECT_LE(dssim(frames[i][1], two[i][1]), kRightDssimMax) << text(c) << ", frame " << i;
      EXPECT_GT(dssim(two[i][0], two[i][1]), 2.0 * kRightDssimMax) << "the eyes see alike: nothing is proved";
    }
  }

  /// From the pose it was cast from a warp shows the eye frame.
  void expect_shown(const Combination& c, Rig& rig) {
    const std::string key = c.warp == "volumetric" ? c.warp + c.rays : c.warp;
    std::unique_ptr<PanelDisplay>& display = displays_[key];
    if (!display) display = rig.display(c.warp);
    const PanelPair panels = rig.panels(*display);
    const PanelPair& plain = plain_.emplace(c.stereo + c.rays, panels).first->second;
    const double most = c.warp != "volumetric" ? 1e-3
                        : c.rays == "mab"      ? kCoarseDssimMax
                                               : kVolumetricDssimMax;
    for (std::size_t eye = 0; eye < 2; ++eye)
      EXPECT_LE(dssim(panels[eye], plain[eye]), most) << text(c) << ", eye " << eye;
  }

  std::map<std::string, int> done_, refused_;  // by stereo stage
  std::map<std::string, Pictures> two_passes_, first_;
  std::map<std::string, PanelPair> plain_;  // warp/none comes first
  std::map<std::string, std::unique_ptr<PanelDisplay>> displays_;
};

TEST_F(StereoMatrix, EveryCombinationIsLikeTwoPassesOrRefusedByName) {
  std::vector<std::string> skips = stage_registry().names("skip");
  std::erase(skips, "auto");       // becomes one of the others
  std::erase(skips, "occlusion");  // for two passes at full rate alone, with tests of its own
  ASSERT_GE(skips.size(), 6u);
  for (const char* stereo : {"two_pass", "layers", "novel_view"})
    for (const char* rays : {"full_rate", "mab"})
      for (const std::string& skip : skips) {
        try_renderer({stereo, rays, skip, "whole_frame", ""}, {"none", "quad", "grid"});
        try_renderer({stereo, rays, skip, "whole_frame", ""}, {"volumetric"});
      }
  const int all = static_cast<int>(2 * skips.size() * 2 * 4);  // of one stereo stage
  for (const char* stereo : {"two_pass", "layers", "novel_view"}) {
    EXPECT_EQ(done_[stereo] + refused_[stereo], all) << stereo;
    RecordProperty(std::string("refused_") + stereo, refused_[stereo]);
  }
  EXPECT_EQ(refused_["two_pass"], 0);
  // Both rays stages and the warps that take no layers, in both schedules; novel_view's over an atlas has
  // tests of its own.
  EXPECT_GE(done_["layers"], static_cast<int>(skips.size() * 2 * 2 * 3));
  EXPECT_GE(done_["novel_view"], static_cast<int>(skips.size() * 2 * 3));
}

}  // namespace
}  // namespace brace
