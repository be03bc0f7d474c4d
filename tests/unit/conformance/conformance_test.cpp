#include "runtime/conformance/conformance.hpp"

#include <gmock/gmock.h>

#include "gpu/gpu_fixture.hpp"
#include "host/temporary_folder.hpp"
#include "stages.hpp"

namespace brace {
namespace {

class Conformance : public gpu::GpuTest {
 protected:
  static std::vector<ClauseResult> check(const StageInfo& stage) {
    CheckOptions options;
    options.device = &device();
    options.data_folder = BRACE_DATA_FOLDER;
    options.large_width_px = 160;  // the command's own large size would take the tests' whole time
    options.large_height_px = 96;
    return check_stage(stage, options);
  }

  static std::vector<std::string> broken_clauses(const StageInfo& stage) {
    std::vector<std::string> broken;
    for (const ClauseResult& result : check(stage)) {
      if (!result.passed) broken.push_back(result.clause);
    }
    return broken;
  }

  static void expect_all_kept(const StageInfo& stage) {
    const std::vector<ClauseResult> results = check(stage);
    EXPECT_GE(results.size(), 5u) << stage.id();
    for (const ClauseResult& result : results) {
      EXPECT_TRUE(result.passed) << stage.id() << ": " << result.clause << ": " << result.figure;
      EXPECT_FALSE(result.figure.empty()) << result.clause;
    }
  }
};

TEST_F(Conformance, EveryExampleKeepsEveryClause) {
  expect_all_kept(example_stage("alpha_beta.so", "predict", "alpha_beta"));
  expect_all_kept(example_stage("aimd_control.so", "control", "aimd"));
  const std::filesystem::path sources = std::filesystem::path(BRACE_SOURCE_DIR) / "plugins/examples";
  expect_all_kept(stage_from(sources / "mip/stage.toml", "cast", "mip"));
  expect_all_kept(stage_from(sources / "isosurface/stage.toml", "cast", "isosurface"));
  expect_all_kept(stage_from(sources / "extrapolate/stage.toml", "warp", "extrapolate"));
}

TEST_F(Conformance, ReferenceRaycasterKeepsEveryClause) {
  expect_all_kept(example_stage("reference_cast.so", "cast", "reference"));
}

TEST_F(Conformance, StagesThatAreNothingByThemselvesAreRefusedByName) {
  const std::filesystem::path stages = std::filesystem::path(BRACE_DATA_FOLDER) / "stages";
  for (const auto& [family, name] : {std::pair("rays", "mab"), {"skip", "auto"}, {"schedule", "chunked"}}) {
    try {
      check(stage_from(stages / family / name / "stage.toml", family, name));
      ADD_FAILURE() << family << "/" << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
      EXPECT_THAT(error.what(), testing::HasSubstr("accepted: "));
    }
  }
}

TEST_F(Conformance, BuiltInStagesKeepEveryClause) {
  const std::filesystem::path stages = std::filesystem::path(BRACE_DATA_FOLDER) / "stages";
  expect_all_kept(stage_from(stages / "cast/dvr/stage.toml", "cast", "dvr"));
  expect_all_kept(stage_from(stages / "rays/full_rate/stage.toml", "rays", "full_rate"));
  expect_all_kept(stage_from(stages / "warp/quad/stage.toml", "warp", "quad"));
  for (const std::string skip :
       {"none", "block", "bitmask", "distance_map", "octree", "partitioned", "occlusion"})
    expect_all_kept(stage_from(stages / "skip" / skip / "stage.toml", "skip", skip));
}

TEST_F(Conformance, TheBrokenLibraryWithoutADefectKeepsEveryClause) {
  for (const char* family : {"cast", "rays", "skip", "stereo", "warp", "predict", "control", "cost"}) {
    expect_all_kept(broken_stage(family, BROKEN_NONE));
  }
}

struct Mutant {
  const char* family;
  int defect;
  const char* clause;
};

void PrintTo(const Mutant& mutant, std::ostream* out) {
  *out << mutant.family << " breaks " << mutant.clause;
}

/// Tests of a value-parameterised suite need one device as well.
class ConformanceMutant : public Conformance, public testing::WithParamInterface<Mutant> {};

TEST_P(ConformanceMutant, BreaksItsClauseAndNoOther) {
  if (GetParam().defect == BROKEN_BREAKS_VALIDATION && !device().validation_enabled()) {
    GTEST_SKIP() << "validation layers are not installed";
  }
  EXPECT_THAT(broken_clauses(broken_stage(GetParam().family, GetParam().defect)),
              testing::ElementsAre(GetParam().clause));
  if (GetParam().defect == BROKEN_BREAKS_VALIDATION) forget_messages();
}

const Mutant mutants[] = {
    {"cast", BROKEN_CREATE_FAILS, "lifecycle"},
    {"cast", BROKEN_ACTIVATE_FAILS, "lifecycle"},
    {"cast", BROKEN_RECORD_FAILS, "lifecycle"},
    {"cast", BROKEN_SECOND_ACTIVATION_FAILS, "repeated activation"},
    {"cast", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"cast", BROKEN_FAILS_AT_EXTREMES, "parameters at their ends"},
    {"cast", BROKEN_LEAKS, "no leaks"},
    {"cast", BROKEN_ALLOCATES, "no allocation per frame"},
    {"cast", BROKEN_FAILS_ODD_SIZES, "sizes from 1x1 to odd to large"},
    {"cast", BROKEN_LEAVES_SOME_OUT, "every ray is written"},
    {"cast", BROKEN_NOT_A_NUMBER, "results are finite"},
    {"cast", BROKEN_COLOUR_OVER_OPACITY, "colours within [0, opacity]"},
    {"cast", BROKEN_OPACITY_OVER_ONE, "opacity within [0, 1]"},
    {"cast", BROKEN_BAD_DEPTH, "depths are distances"},
    {"cast", BROKEN_PAINTS_MISSES, "rays that miss stay transparent"},
    {"cast", BROKEN_CHANGES_INPUT, "inputs are left alone"},
    {"cast", BROKEN_WRITES_BEHIND_BUFFER, "nothing behind the buffers"},
    {"cast", BROKEN_WRITES_OUTSIDE_AREA, "nothing outside the area"},
    {"rays", BROKEN_RECORD_FAILS, "lifecycle"},
    {"rays", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"rays", BROKEN_SECOND_ACTIVATION_FAILS, "repeated activation"},
    {"rays", BROKEN_FAILS_AT_EXTREMES, "parameters at their ends"},
    {"rays", BROKEN_FAILS_ODD_SIZES, "sizes from 1x1 to odd to large"},
    {"rays", BROKEN_LEAKS, "no leaks"},
    {"rays", BROKEN_LEAVES_SOME_OUT, "every ray and pixel is written"},
    {"rays", BROKEN_NOT_A_NUMBER, "rays are finite and enter inside the box"},
    {"rays", BROKEN_COLOUR_OVER_OPACITY, "colours within [0, opacity]"},
    {"rays", BROKEN_BAD_DEPTH, "depths are distances"},
    {"rays", BROKEN_CHANGES_INPUT, "inputs are left alone"},
    {"rays", BROKEN_WRITES_BEHIND_BUFFER, "nothing behind the buffers"},
    {"skip", BROKEN_OUT_OF_RANGE, "lifecycle"},
    {"skip", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"skip", BROKEN_SECOND_ACTIVATION_FAILS, "repeated activation"},
    {"skip", BROKEN_FAILS_AT_EXTREMES, "parameters at their ends"},
    {"skip", BROKEN_LEAKS, "no leaks"},
    {"skip", BROKEN_ALLOCATES, "no allocation per frame"},
    {"skip", BROKEN_LEAVES_SOME_OUT, "every block is written"},
    {"skip", BROKEN_IGNORES_OPAQUE, "no distance reaches past a visible block"},
    {"skip", BROKEN_WRITES_BEHIND_BUFFER, "nothing behind the buffers"},
    {"stereo", BROKEN_RECORD_FAILS, "lifecycle"},
    {"stereo", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"stereo", BROKEN_SECOND_ACTIVATION_FAILS, "repeated activation"},
    {"stereo", BROKEN_FAILS_AT_EXTREMES, "parameters at their ends"},
    {"stereo", BROKEN_FAILS_ODD_SIZES, "sizes from 1x1 to odd to large"},
    {"stereo", BROKEN_LEAKS, "no leaks"},
    {"stereo", BROKEN_LEAVES_SOME_OUT, "every pixel is written"},
    {"stereo", BROKEN_COLOUR_OVER_OPACITY, "colours within [0, opacity]"},
    {"stereo", BROKEN_BAD_DEPTH, "depths are distances"},
    {"stereo", BROKEN_CHANGES_INPUT, "inputs are left alone"},
    {"stereo", BROKEN_WRITES_BEHIND_BUFFER, "nothing behind the buffers"},
    {"stereo", BROKEN_BREAKS_VALIDATION, "validation layers silent"},
    {"warp", BROKEN_RECORD_FAILS, "lifecycle"},
    {"warp", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"warp", BROKEN_FAILS_ODD_SIZES, "sizes from 1x1 to odd to large"},
    {"warp", BROKEN_LEAKS, "no leaks"},
    {"warp", BROKEN_LEAVES_SOME_OUT, "every pixel is written"},
    {"warp", BROKEN_COLOUR_OVER_OPACITY, "colours within [0, opacity]"},
    {"warp", BROKEN_CHANGES_INPUT, "inputs are left alone"},
    {"warp", BROKEN_WRITES_BEHIND_BUFFER, "nothing behind the buffers"},
    {"warp", BROKEN_BREAKS_VALIDATION, "validation layers silent"},
    {"predict", BROKEN_CREATE_FAILS, "lifecycle"},
    {"predict", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"predict", BROKEN_SECOND_ACTIVATION_FAILS, "repeated activation"},
    {"predict", BROKEN_FAILS_AT_EXTREMES, "parameters at their ends"},
    {"predict", BROKEN_LEAKS, "no leaks"},
    {"predict", BROKEN_ALLOCATES, "no allocation per frame"},
    {"predict", BROKEN_FAILS_ODD_INPUT, "extreme input is served"},
    {"predict", BROKEN_NOT_A_NUMBER, "poses are finite"},
    {"predict", BROKEN_OUT_OF_RANGE, "orientations are unit quaternions"},
    {"control", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"control", BROKEN_ALLOCATES, "no allocation per frame"},
    {"control", BROKEN_LEAKS, "no leaks"},
    {"control", BROKEN_NOT_A_NUMBER, "quality within (0, 1]"},
    {"control", BROKEN_OUT_OF_RANGE, "quality within (0, 1]"},
    {"cost", BROKEN_NOT_DETERMINISTIC, "determinism"},
    {"cost", BROKEN_ALLOCATES, "no allocation per frame"},
    {"cost", BROKEN_OUT_OF_RANGE, "durations are not negative"},
};

INSTANTIATE_TEST_SUITE_P(Each, ConformanceMutant, testing::ValuesIn(mutants), [](const auto& each) {
  return std::string(each.param.family) + "_" + std::to_string(each.param.defect);
});

struct GlslMutant {
  const char* name;
  const char* family;
  const char* snippet;
  const char* clause;
};

void PrintTo(const GlslMutant& mutant, std::ostream* out) {
  *out << mutant.name;
}

class ConformanceGlslMutant : public Conformance, public testing::WithParamInterface<GlslMutant> {};

TEST_P(ConformanceGlslMutant, BreaksItsClauseAndNoOther) {
  const TemporaryFolder folder;
  folder.write("snippet.glsl", GetParam().snippet);
  const auto manifest = folder.write(
      "stage.toml", std::string("[stage]\nkind='") + GetParam().family +
                        "'\nname='mutant'\nversion='1'\nhelp='h'\nsource='snippet.glsl'\n[[parameter]]\n"
                        "name='gain'\ntype='float'\nmin=0\nmax=1\ndefault=0.5\nhelp='g'\n");
  EXPECT_THAT(broken_clauses(stage_from(manifest, GetParam().family, "mutant")),
              testing::ElementsAre(GetParam().clause));
}

#define CAST(body) "void brace_cast(BraceRay ray, inout BraceResult result) {" body "}\n"
#define GOOD "result.colour = vec4(0.25, 0.25, 0.5 * cast_gain, 0.5); result.depth = 0.5 * ray.extent;"
#define RAYS(open, close)                                                                                  \
  "#if defined(BRACE_KERNEL_OPENING)\nBraceRay brace_open(uvec2 cell) {"                                   \
  "BraceRay ray = brace_ray_through(vec2(cell) + 0.5);" open                                               \
  "return ray; }\n#endif\n"                                                                                \
  "#if defined(BRACE_KERNEL_CLOSING)\nvoid brace_close(uvec2 pixel, out vec4 colour, out float depth_m) {" \
  "const uint index = brace_ray_index(pixel); colour = brace_result_colours[index];"                       \
  "depth_m = brace_result_depths_m[index];" close "}\n#endif\n"

const GlslMutant glsl_mutants[] = {
    {"cast_does_not_compile", "cast", CAST("result.colour = nothing;"), "lifecycle"},
    {"cast_binds_what_nobody_fills", "cast",
     "layout(std430, set = 0, binding = 30) buffer Own { float own[]; };\n" CAST(GOOD
                                                                                 "result.depth += own[0];"),
     "lifecycle"},
    {"cast_nan", "cast", CAST(GOOD "result.colour.g = sqrt(-ray.extent);"), "results are finite"},
    {"cast_colour", "cast", CAST(GOOD "result.colour.r = 0.75;"), "colours within [0, opacity]"},
    {"cast_opacity", "cast", CAST(GOOD "result.colour.a = 1.5;"), "opacity within [0, 1]"},
    {"cast_depth", "cast", CAST(GOOD "result.depth = BRACE_NO_HIT;"), "depths are distances"},
    {"cast_changes_rays", "cast", CAST(GOOD "brace_ray_directions[0].w = 3.0;"), "inputs are left alone"},
    {"cast_writes_behind", "cast",
     CAST(GOOD "brace_result_depths_m[brace_eye.grid.x * brace_eye.grid.y + 5u] = 1.0;"),
     "nothing behind the buffers"},
    {"cast_writes_neighbours", "cast",
     CAST(GOOD "const uvec2 cell = brace_area.origin + gl_GlobalInvocationID.xy;"
               "if (brace_area.origin.x > 0u) brace_result_depths_m[brace_ray_index(cell) - 1u] = 1.0;"),
     "nothing outside the area"},
    {"cast_ends", "cast", CAST(GOOD "if (cast_gain == 1.0) result.colour.a = 2.0;"),
     "parameters at their ends"},
    {"rays_nan", "rays", RAYS("ray.extent = log(-1.0 - ray.extent);", ""),
     "rays are finite and enter inside the box"},
    {"rays_enter_outside", "rays", RAYS("ray.entry.x += 100.0;", ""),
     "rays are finite and enter inside the box"},
    {"rays_colour", "rays", RAYS("", "colour.r = colour.a + 0.1;"), "colours within [0, opacity]"},
    {"rays_depth", "rays", RAYS("", "depth_m = -1.0;"), "depths are distances"},
    {"rays_change_results", "rays", RAYS("", "brace_result_depths_m[index] += 1.0;"),
     "inputs are left alone"},
    {"skip_too_far", "skip",
     "#define BRACE_SKIP\nint brace_skip(BraceRay ray, vec3 voxel, int i, float step) { return 9; }\n",
     "the picture is the unskipped one, bit for bit"},
    {"warp_shifts", "warp", "vec2 brace_warp_source(vec2 tan_xy) { return tan_xy + 0.3; }\n",
     "equal poses show the picture as it is"},
    {"warp_shifts_odd_sizes", "warp",
     "vec2 brace_warp_source(vec2 tan_xy) { return tan_xy + (brace_display.grid.z % 2u == 1u ? 0.3 : 0.0); "
     "}\n",
     "sizes from 2x2 to odd to large"},
};

INSTANTIATE_TEST_SUITE_P(Each, ConformanceGlslMutant, testing::ValuesIn(glsl_mutants),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace brace
