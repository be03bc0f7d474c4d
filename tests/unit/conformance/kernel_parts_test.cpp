// What a session does not use is not in its kernel: looked up in the SPIR-V.
#include <set>

#include "gpu/gpu_fixture.hpp"
#include "runtime/conformance/bench_scene.hpp"
#include "stages.hpp"

namespace brace {
namespace {

/// Instructions of a module by opcode; of the GLSL.std.450 set by number.
struct Instructions {
  std::multiset<std::uint32_t> opcodes, extended;
  std::set<std::uint32_t> slots;
};

Instructions instructions_of(const gpu::CompiledKernel& kernel) {
  constexpr std::uint32_t op_ext_inst = 12, header_words = 5;
  Instructions found;
  for (std::size_t at = header_words; at < kernel.spirv.size(); at += kernel.spirv[at] >> 16) {
    const std::uint32_t opcode = kernel.spirv[at] & 0xffffu;
    found.opcodes.insert(opcode);
    if (opcode == op_ext_inst) found.extended.insert(kernel.spirv[at + 4]);
  }
  for (const auto& binding : gpu::reflect(kernel.spirv, "kernel").bindings)
    found.slots.insert(binding.slot);
  return found;
}

constexpr std::uint32_t op_function_call = 57, op_atomic_add = 234, ext_pow = 26;

class KernelParts : public gpu::GpuTest {
 protected:
  static Instructions cast_kernel(bool phong, bool counters, const char* skip) {
    const std::filesystem::path data = BRACE_DATA_FOLDER;
    const PipelineStage dvr = with_defaults(stage_from(data / "stages/cast/dvr/stage.toml", "cast", "dvr"));
    const PipelineStage skipping =
        with_defaults(stage_from(data / "stages/skip" / skip / "stage.toml", "skip", skip));
    const PipelineStage* const chosen[] = {&dvr, &skipping};
    StageGlsl glsl = stage_glsl(chosen);
    CastParts parts;
    parts.glsl_folder = data / "glsl";
    parts.kernels_folder = data / "kernels";
    parts.stages = std::move(glsl.resolve);
    parts.native_rays = true;
    parts.phong = phong;
    parts.counters = counters;
    const BenchScene scene(device());
    return instructions_of(gpu::compile(compose_cast_kernels(parts, scene.volume).cast));
  }
};

TEST_F(KernelParts, SessionWithoutShadingSkippingAndCountingHasNoneOfTheirInstructions) {
  const Instructions plain = cast_kernel(false, false, "none");
  EXPECT_EQ(plain.extended.count(ext_pow), 0u);
  EXPECT_EQ(plain.opcodes.count(op_atomic_add), 0u);
  EXPECT_EQ(plain.slots, (std::set<std::uint32_t>{CastSlot::eye, CastSlot::ray_entry, CastSlot::ray_direction,
                                                  CastSlot::result_colour, CastSlot::result_depth,
                                                  CastSlot::volume, CastSlot::transfer}));
}

TEST_F(KernelParts, EachPartBringsItsOwnInstructions) {
  const Instructions plain = cast_kernel(false, false, "none");
  const Instructions lit = cast_kernel(true, false, "none");
  EXPECT_GT(lit.extended.count(ext_pow), 0u);
  EXPECT_GT(lit.opcodes.count(op_function_call), plain.opcodes.count(op_function_call));
  const Instructions counted = cast_kernel(false, true, "none");
  EXPECT_GT(counted.opcodes.count(op_atomic_add), 0u);
  EXPECT_TRUE(counted.slots.contains(CastSlot::counters));
  const Instructions skipping = cast_kernel(false, false, "distance_map");
  EXPECT_TRUE(skipping.slots.contains(10));
  EXPECT_GT(skipping.opcodes.size(), plain.opcodes.size());
}

}  // namespace
}  // namespace brace
