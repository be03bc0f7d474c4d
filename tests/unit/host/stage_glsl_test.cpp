#include "runtime/host/stage_glsl.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/gpu/pipeline.hpp"
#include "temporary_folder.hpp"

namespace brace {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

PipelineStage with_parameters(const char* family) {
  PipelineStage stage;
  stage.stage.family = family;
  stage.stage.name = "x";
  const auto add = [&](const char* name, ParameterType type, double fallback, double value) {
    StageParameter parameter;
    parameter.name = name;
    parameter.type = type;
    parameter.default_value = fallback;
    stage.stage.parameters.push_back(parameter);
    stage.values.push_back(value);
  };
  add("step", ParameterType::floating, 0.5, 0.25);
  add("count", ParameterType::integer, 3, -7);
  add("on", ParameterType::boolean, 0, 1);
  add("mode", ParameterType::choice, 1, 2);
  stage.stage.parameters.back().choices = {"fast", "plain", "exact"};
  return stage;
}

TEST(StageGlsl, ParametersBecomeSpecialisationConstantsOfTheirFamily) {
  const std::string text = parameter_declarations(with_parameters("cast").stage);
  EXPECT_THAT(text, AllOf(HasSubstr("const float cast_step = 5.000000000e-01;"),
                          HasSubstr("const int cast_count = 3;"), HasSubstr("const bool cast_on = false;"),
                          HasSubstr("const int cast_mode = 1;")));
}

TEST(StageGlsl, ConstantsCarryTheSessionsValues) {
  const auto constants = parameter_constants(with_parameters("rays"));
  ASSERT_EQ(constants.size(), 4u);
  EXPECT_EQ(constants[0], gpu::spec_constant(0, 0.25f));
  EXPECT_EQ(constants[1], gpu::spec_constant(1, -7));
  EXPECT_EQ(constants[2], gpu::spec_constant(2, true));
  EXPECT_EQ(constants[3], gpu::spec_constant(3, 2));
}

TEST(StageGlsl, FamiliesHaveConstantsOfTheirOwn) {
  std::set<std::uint32_t> ids;
  for (const std::string& family : stage_families()) {
    for (const auto& constant : parameter_constants(with_parameters(family.c_str())))
      ids.insert(constant.id);
  }
  EXPECT_EQ(ids.size(), 4 * stage_families().size());
}

/// A kernel that calls the cast stage's snippet, and nothing else.
gpu::KernelDescription kernel_around(const PipelineStage& stage) {
  const PipelineStage* const chosen[] = {&stage};
  StageGlsl glsl = stage_glsl(chosen);
  gpu::KernelDescription kernel;
  kernel.main = {"test kernel",
                 "#version 460\n#include \"stage/parameters.glsl\"\n#include \"stage/skip.glsl\"\n"
                 "#include \"stage/cast.glsl\"\nlayout(local_size_x = 8) in;\n"
                 "layout(set = 0, binding = 0) buffer Out { float values[]; };\n"
                 "void main() { values[gl_GlobalInvocationID.x] = snippet(); }\n"};
  kernel.resolve = std::move(glsl.resolve);
  kernel.constants = std::move(glsl.constants);
  return kernel;
}

PipelineStage snippet_stage(const TemporaryFolder& folder, const std::string& snippet) {
  PipelineStage stage = with_parameters("cast");
  stage.stage.glsl_source = folder.write("snippet.glsl", snippet);
  return stage;
}

TEST(StageGlsl, CompileErrorNamesTheAuthorsFileAndLine) {
  const TemporaryFolder folder;
  const PipelineStage stage =
      snippet_stage(folder, "float snippet() {\n  float a = cast_step;\n  return a + no_such_thing;\n}\n");
  try {
    (void)gpu::compile(kernel_around(stage), {.use_cache = false, .cache_folder = {}});
    FAIL() << "compiled";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), AllOf(HasSubstr(stage.stage.glsl_source.string() + ":3"),
                                    HasSubstr("no_such_thing"), Not(HasSubstr("test kernel"))));
  }
}

TEST(StageGlsl, CompileErrorInAFileBesideTheSnippetNamesThatFile) {
  const TemporaryFolder folder;
  folder.write("beside.glsl", "// one\n// two\nfloat beside() { return missing; }\n");
  const PipelineStage stage =
      snippet_stage(folder, "#include \"beside.glsl\"\nfloat snippet() { return beside(); }\n");
  try {
    (void)gpu::compile(kernel_around(stage), {.use_cache = false, .cache_folder = {}});
    FAIL() << "compiled";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("beside.glsl:3"), HasSubstr("missing")));
  }
}

TEST(StageGlsl, SnippetSeesItsParametersAndStagesWithoutSnippetAreEmpty) {
  const TemporaryFolder folder;
  const PipelineStage stage = snippet_stage(
      folder, "float snippet() { return cast_on ? cast_step + float(cast_count + cast_mode) : 0.0; }\n");
  EXPECT_GT(gpu::compile(kernel_around(stage), {.use_cache = false, .cache_folder = {}}).spirv.size(), 10u);
}

TEST(StageGlsl, TooManyParametersAreRefused) {
  PipelineStage stage = with_parameters("cast");
  stage.stage.parameters.resize(65, stage.stage.parameters[0]);
  EXPECT_THROW((void)parameter_declarations(stage.stage), Error);
}

}  // namespace
}  // namespace brace
