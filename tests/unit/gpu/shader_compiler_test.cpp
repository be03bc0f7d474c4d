#include "runtime/gpu/shader_compiler.hpp"

#include <cstdlib>
#include <fstream>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace brace::gpu {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* main_text = R"(#version 460
layout(local_size_x = 8) in;
layout(binding = 0, std430) buffer Out { float value[]; } result;
#include "stage/warp.glsl"
void main() { result.value[gl_GlobalInvocationID.x] = warp(SCALE); }
)";

// A temporary folder of this test, removed at its end.
class ShaderCompiler : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "brace_spirv_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  KernelDescription kernel() const {
    KernelDescription description;
    description.main = {"main.comp", main_text};
    description.resolve = [this](std::string_view name) -> std::optional<GlslSource> {
      const auto found = files_.find(std::string(name));
      if (found == files_.end()) return std::nullopt;
      return found->second;
    };
    description.defines = {{"SCALE", "2.0"}};
    return description;
  }
  CompileOptions options() const { return {.use_cache = true, .cache_folder = folder_}; }
  std::string error_text(const KernelDescription& description) const {
    try {
      (void)compile(description, options());
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
      return error.what();
    }
    return "";
  }
  std::vector<std::filesystem::path> entries() const {
    return {std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()};
  }

  std::filesystem::path folder_;
  std::map<std::string, GlslSource> files_{
      {"stage/warp.glsl",
       {"stages/warp/test/test.glsl",
        "#include \"common.glsl\"\nfloat warp(float x) { return twice(x); }\n"}},
      {"common.glsl", {"include/common.glsl", "float twice(float x) { return 2.0 * x; }\n"}}};
};

TEST_F(ShaderCompiler, FollowsNestedIncludesAndNamesTheSources) {
  const CompiledKernel compiled = compile(kernel(), options());
  EXPECT_EQ(compiled.spirv.at(0), 0x07230203u);
  EXPECT_THAT(compiled.sources,
              ElementsAre("main.comp", "stages/warp/test/test.glsl", "include/common.glsl"));
}

TEST_F(ShaderCompiler, SecondCompilationHitsTheCacheWithTheSameCode) {
  const CompiledKernel first = compile(kernel(), options());
  const CompiledKernel second = compile(kernel(), options());
  EXPECT_FALSE(first.cache_hit);
  EXPECT_TRUE(second.cache_hit);
  EXPECT_EQ(first.spirv, second.spirv);
  EXPECT_EQ(first.sources, second.sources);
  EXPECT_FALSE(compile(kernel(), {.use_cache = false, .cache_folder = folder_}).cache_hit);
}

TEST_F(ShaderCompiler, AnyChangeOfContentMissesTheCache) {
  (void)compile(kernel(), options());
  files_["common.glsl"].text += "\n";
  EXPECT_FALSE(compile(kernel(), options()).cache_hit);
  KernelDescription other = kernel();
  other.defines[0].second = "3.0";
  EXPECT_FALSE(compile(other, options()).cache_hit);
  other.main.text += "// more\n";
  EXPECT_FALSE(compile(other, options()).cache_hit);
  other.constants = {spec_constant(1, 2.0f)};  // no part of the code
  EXPECT_TRUE(compile(other, options()).cache_hit);
}

TEST_F(ShaderCompiler, DamagedCacheEntriesAreCompiledAnew) {
  const CompiledKernel good = compile(kernel(), options());
  ASSERT_EQ(entries().size(), 1u);
  const std::filesystem::path entry = entries()[0];
  const auto size = std::filesystem::file_size(entry);
  const std::function<void()> damages[] = {
      [&] { std::filesystem::resize_file(entry, 0); }, [&] { std::filesystem::resize_file(entry, size - 4); },
      [&] { std::filesystem::resize_file(entry, size + 4); },
      [&] { std::filesystem::resize_file(entry, 10); },
      [&] {
        std::fstream file(entry, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(size / 2));
        file.put('\x5a');
      }};
  for (const auto& damage : damages) {
    damage();
    const CompiledKernel again = compile(kernel(), options());
    EXPECT_FALSE(again.cache_hit);
    EXPECT_EQ(again.spirv, good.spirv);
    EXPECT_TRUE(compile(kernel(), options()).cache_hit);
  }
}

TEST_F(ShaderCompiler, ConcurrentWritersLeaveOneWholeEntry) {
  const CompiledKernel good = compile(kernel(), {.use_cache = false, .cache_folder = {}});
  std::vector<std::thread> threads;
  std::vector<std::vector<std::uint32_t>> results(8);
  for (auto& result : results)
    threads.emplace_back([this, &result] { result = compile(kernel(), options()).spirv; });
  for (std::thread& thread : threads)
    thread.join();
  for (const auto& result : results)
    EXPECT_EQ(result, good.spirv);
  EXPECT_EQ(entries().size(), 1u);  // no temporary file is left
}

TEST_F(ShaderCompiler, AnUnwritableCacheDoesNotStopCompilation) {
  std::ofstream(folder_ / "file") << "not a folder";
  EXPECT_FALSE(
      compile(kernel(), {.use_cache = true, .cache_folder = folder_ / "file" / "sub"}).spirv.empty());
}

TEST_F(ShaderCompiler, ErrorsNameTheIncludedFileAndItsOwnLine) {
  files_["common.glsl"].text = "// a comment\n\nfloat twice(float x) { return 2.0 * y; }\n";
  EXPECT_THAT(error_text(kernel()), HasSubstr("include/common.glsl:3: 'y' : undeclared identifier"));
  files_["common.glsl"].text = "float twice(float x) { return 2.0 * x; }\n";
  files_["stage/warp.glsl"].text = "#include \"common.glsl\"\n\nfloat warp(float x) { return twise(x); }\n";
  EXPECT_THAT(error_text(kernel()), HasSubstr("stages/warp/test/test.glsl:3: 'twise'"));
  KernelDescription other = kernel();
  files_["stage/warp.glsl"].text = "#include \"common.glsl\"\nfloat warp(float x) { return x; }\n";
  other.main.text += "broken\n";
  EXPECT_THAT(error_text(other), HasSubstr("main.comp:"));
  EXPECT_THAT(error_text(other), Not(HasSubstr("compilation errors")));
}

TEST_F(ShaderCompiler, AMissingIncludeIsNamedWhereItIsWritten) {
  files_.erase("common.glsl");
  const std::string text = error_text(kernel());
  EXPECT_THAT(text, HasSubstr("stages/warp/test/test.glsl:1:"));
  EXPECT_THAT(text, HasSubstr("common.glsl"));
}

TEST_F(ShaderCompiler, AnIncludeCycleIsAnError) {
  files_["common.glsl"].text = "#include \"stage/warp.glsl\"\n";
  EXPECT_THAT(error_text(kernel()), HasSubstr("include itself"));
}

TEST_F(ShaderCompiler, DirectoryResolverStaysInsideItsFolders) {
  std::filesystem::create_directories(folder_ / "a" / "sub");
  std::ofstream(folder_ / "a" / "sub" / "x.glsl") << "int x;";
  std::ofstream(folder_ / "secret.glsl") << "int y;";
  const IncludeResolver resolve = directory_resolver({folder_ / "missing", folder_ / "a"});
  ASSERT_TRUE(resolve("sub/x.glsl").has_value());
  EXPECT_EQ(resolve("sub/x.glsl")->text, "int x;");
  EXPECT_EQ(resolve("sub/x.glsl")->name, "sub/x.glsl");
  EXPECT_FALSE(resolve("../secret.glsl").has_value());
  EXPECT_FALSE(resolve((folder_ / "secret.glsl").string()).has_value());
  EXPECT_FALSE(resolve("sub").has_value());
  const IncludeResolver chained = chain_resolvers({resolve, directory_resolver({folder_})});
  EXPECT_TRUE(chained("secret.glsl").has_value());
}

}  // namespace
}  // namespace brace::gpu
