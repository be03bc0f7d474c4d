#include "runtime/gpu/shader_compiler.hpp"

#include <sstream>

#include <fmt/core.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/build_info.h>
#include <spirv-tools/optimizer.hpp>

#include "base/error.hpp"
#include "runtime/gpu/glsl_source.hpp"
#include "runtime/gpu/spirv_cache.hpp"

namespace brace::gpu {
namespace {

// Part of the cache key: change it when anything below changes what comes out.
constexpr std::string_view settings = "vulkan1.3 spirv1.5 pruned 1";

constexpr std::size_t include_depth_max = 32;

// glslang keeps process-wide tables; they live from the first compilation to the end of the process.
void ensure_glslang() {
  struct Process {
    Process() { glslang::InitializeProcess(); }
    ~Process() { glslang::FinalizeProcess(); }
  };
  static const Process process;
}

class Includer : public glslang::TShader::Includer {
 public:
  explicit Includer(const IncludeClosure& closure) : closure_(closure) {}

  IncludeResult* includeLocal(const char* name, const char* includer, std::size_t depth) override {
    return find(name, includer, depth);
  }
  IncludeResult* includeSystem(const char* name, const char* includer, std::size_t depth) override {
    return find(name, includer, depth);
  }
  void releaseInclude(IncludeResult* result) override { delete result; }

 private:
  // The header name of the result is what messages call the file. An empty one says "not found", with the
  // data as the reason.
  IncludeResult* find(const char* name, const char*, std::size_t depth) {
    if (depth > include_depth_max) return new IncludeResult("", too_deep.data(), too_deep.size(), nullptr);
    const auto found = closure_.found.find(name);
    if (found == closure_.found.end()) return nullptr;
    const GlslSource& source = found->second;
    return new IncludeResult(source.name, source.text.data(), source.text.size(), nullptr);
  }

  static constexpr std::string_view too_deep = "includes nest too deeply; does a file include itself?";
  const IncludeClosure& closure_;
};

std::string preamble_of(const KernelDescription& kernel) {
  std::string text = "#extension GL_GOOGLE_include_directive : require\n";
  for (const auto& [name, value] : kernel.defines)
    text += fmt::format("#define {} {}\n", name, value);
  return text;
}

// "ERROR: name:12: what" -> "name:12: what"; drops the summary lines.
// After the first error the parser loses its way: what it then says of other files, such as the kernel around
// an author's snippet, is no help.
std::string tidy_log(const char* log) {
  std::istringstream lines(log);
  std::string text, line, first_file;
  while (std::getline(lines, line)) {
    constexpr std::string_view prefix = "ERROR: ";
    if (line.starts_with(prefix)) line.erase(0, prefix.size());
    while (!line.empty() && line.back() == ' ')
      line.pop_back();
    if (line.empty() || line.find("compilation errors.") != std::string::npos) continue;
    const std::string file = line.substr(0, line.find(':'));
    if (first_file.empty()) first_file = file;
    if (file != first_file || line.find("compilation terminated") != std::string::npos) continue;
    text += "\n  " + line;
  }
  return text;
}

// Drops functions and bindings that nothing reaches, so that a kernel asks only for what it uses. Everything
// else is left to the driver's compiler, which sees the specialised code.
std::vector<std::uint32_t> prune(const std::vector<std::uint32_t>& spirv, const std::string& name) {
  spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_3);
  optimizer.RegisterPass(spvtools::CreateDeadBranchElimPass());
  optimizer.RegisterPass(spvtools::CreateEliminateDeadFunctionsPass());
  optimizer.RegisterPass(spvtools::CreateAggressiveDCEPass());
  std::vector<std::uint32_t> pruned;
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);
  if (!optimizer.Run(spirv.data(), spirv.size(), &pruned, options))
    throw input_error("{}: the SPIR-V that comes out cannot be pruned", name);
  return pruned;
}

std::vector<std::uint32_t> compile_sources(const KernelDescription& kernel, const IncludeClosure& closure) {
  ensure_glslang();
  glslang::TShader shader(EShLangCompute);
  const char* text = kernel.main.text.c_str();
  const auto length = static_cast<int>(kernel.main.text.size());
  const char* name = kernel.main.name.c_str();
  shader.setStringsWithLengthsAndNames(&text, &length, &name, 1);
  const std::string preamble = preamble_of(kernel);
  shader.setPreamble(preamble.c_str());
  shader.setEnvInput(glslang::EShSourceGlsl, EShLangCompute, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
  Includer includer(closure);
  const auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
  if (!shader.parse(GetDefaultResources(), 460, ECoreProfile, false, false, messages, includer))
    throw input_error("the shader does not compile:{}", tidy_log(shader.getInfoLog()));
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages))
    throw input_error("{}: the shader does not link:{}", kernel.main.name, tidy_log(program.getInfoLog()));

  glslang::SpvOptions options;
  options.disableOptimizer = true;
  spv::SpvBuildLogger logger;
  std::vector<unsigned int> spirv;
  glslang::GlslangToSpv(*program.getIntermediate(EShLangCompute), spirv, &logger, &options);
  if (spirv.empty())
    throw input_error("{}: no SPIR-V comes out:{}", kernel.main.name,
                      tidy_log(logger.getAllMessages().c_str()));
  return prune(spirv, kernel.main.name);
}

std::string compiler_version() {
  return fmt::format("glslang {}.{}.{} {}", GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR,
                     GLSLANG_VERSION_PATCH, settings);
}

}  // namespace

std::string kernel_key(const KernelDescription& kernel) {
  return content_key(kernel, find_includes(kernel), compiler_version());
}

CompiledKernel compile(const KernelDescription& kernel, const CompileOptions& options) {
  const IncludeClosure includes = find_includes(kernel);
  const std::filesystem::path folder =
      options.cache_folder.empty() ? default_cache_folder() : options.cache_folder;
  const bool use_cache = options.use_cache && !folder.empty();
  CompiledKernel result;
  result.sources = includes.order;
  const std::string key = use_cache ? content_key(kernel, includes, compiler_version()) : "";
  if (use_cache) {
    if (std::optional<std::vector<std::uint32_t>> entry = read_cache_entry(folder, key)) {
      result.spirv = std::move(*entry);
      result.cache_hit = true;
      return result;
    }
  }
  result.spirv = compile_sources(kernel, includes);
  if (use_cache) write_cache_entry(folder, key, result.spirv);
  return result;
}

}  // namespace brace::gpu
