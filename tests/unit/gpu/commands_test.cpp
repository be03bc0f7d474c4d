#include "runtime/gpu/commands.hpp"

#include <numeric>
#include <vector>

#include "gpu/gpu_fixture.hpp"

namespace brace::gpu {
namespace {

constexpr const char* add_kernel = R"(#version 460
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;
layout(constant_id = 3) const uint factor = 1u;
layout(constant_id = 4) const float offset = 0.0;
layout(binding = 0, scalar) readonly buffer In { uint values[]; } source;
layout(binding = 2, scalar) writeonly buffer Out { uint values[]; } result;
layout(push_constant, scalar) uniform Params { uvec3 unused; uint count; uint add; } params;
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < params.count) result.values[i] = source.values[i] * factor + params.add + uint(offset);
}
)";

struct AddParams {
  std::uint32_t unused[3] = {};
  std::uint32_t count = 0;
  std::uint32_t add = 0;
};

KernelDescription add_description() {
  KernelDescription kernel;
  kernel.main = {"add.comp", add_kernel};
  return kernel;
}

using Commands = GpuTest;

TEST_F(Commands, DispatchComputesWithBuffersPushConstantsAndSpecialisation) {
  constexpr std::uint32_t count = 1000;
  KernelDescription kernel = add_description();
  kernel.constants = {spec_constant(3, 7u), spec_constant(4, 2.5f), spec_constant(99, 1u)};
  const ComputePipeline pipeline = make_pipeline(device(), kernel, {.use_cache = false, .cache_folder = {}});
  const Buffer in(device(), "in", count * 4, Memory::upload);
  const Buffer out(device(), "out", count * 4, Memory::readback);
  std::iota(in.mapped_as<std::uint32_t>().begin(), in.mapped_as<std::uint32_t>().end(), 0u);

  CommandList commands(device(), "add");
  const AddParams params{{}, count, 5};
  commands.begin_timing("add");
  commands.dispatch(pipeline, {bind(2, out), bind(0, in), bind(7, in)}, push_bytes(params),
                    pipeline.groups_for(count));
  commands.end_timing();
  const std::vector<Timing>& timings = submit_and_wait(commands);
  for (std::uint32_t i = 0; i < count; ++i)
    ASSERT_EQ(out.mapped_as<std::uint32_t>()[i], i * 7 + 7);
  ASSERT_EQ(timings.size(), 1u);
  EXPECT_EQ(timings[0].name, "add");
  EXPECT_GT(device_ns(timings, "add"), 0);
}

TEST_F(Commands, BarrierOrdersDependentDispatches) {
  constexpr std::uint32_t count = 4096;
  const ComputePipeline pipeline = make_pipeline(device(), add_description());
  const Buffer a(device(), "a", count * 4, Memory::device);
  const Buffer b(device(), "b", count * 4, Memory::device);
  const Buffer out(device(), "out", count * 4, Memory::readback);
  CommandList commands(device(), "chain");
  const AddParams params{{}, count, 1};
  commands.fill(a, 40);
  commands.barrier();
  commands.dispatch(pipeline, {bind(0, a), bind(2, b)}, push_bytes(params), pipeline.groups_for(count));
  commands.barrier();
  commands.dispatch(pipeline, {bind(0, b), bind(2, a)}, push_bytes(params), pipeline.groups_for(count));
  commands.barrier();
  commands.copy(a, out, count * 4);
  submit_and_wait(commands);
  for (const std::uint32_t value : out.mapped_as<std::uint32_t>())
    ASSERT_EQ(value, 42u);
}

TEST_F(Commands, ARecordingCanBeSubmittedAgainAndReset) {
  const ComputePipeline pipeline = make_pipeline(device(), add_description());
  const Buffer value(device(), "value", 4, Memory::readback);
  value.mapped_as<std::uint32_t>()[0] = 0;
  CommandList commands(device(), "again");
  const AddParams params{{}, 1, 3};
  commands.begin_timing("t");
  commands.dispatch(pipeline, {bind(0, value), bind(2, value)}, push_bytes(params), {1, 1, 1});
  commands.end_timing();
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(submit_and_wait(commands).size(), 1u);
  EXPECT_EQ(value.mapped_as<std::uint32_t>()[0], 9u);
  commands.reset();
  commands.fill(value, 1);
  EXPECT_TRUE(submit_and_wait(commands).empty());
  EXPECT_EQ(value.mapped_as<std::uint32_t>()[0], 1u);
}

TEST_F(Commands, NestedTimingsContainEachOther) {
  const Buffer buffer(device(), "buffer", 1 << 22, Memory::device);
  CommandList commands(device(), "nested");
  commands.begin_timing("outer");
  commands.begin_timing("inner");
  commands.fill(buffer, 1);
  commands.end_timing();
  commands.barrier();
  commands.begin_timing("inner");
  commands.fill(buffer, 2);
  commands.end_timing();
  commands.end_timing();
  const std::vector<Timing>& timings = submit_and_wait(commands);
  ASSERT_EQ(timings.size(), 3u);
  EXPECT_GE(device_ns(timings, "outer"), device_ns(timings, "inner"));
  EXPECT_EQ(device_ns(timings, "inner"), timings[1].device_ns + timings[2].device_ns);
}

TEST_F(Commands, WrongUseIsReportedWithKernelAndSlot) {
  const ComputePipeline pipeline = make_pipeline(device(), add_description());
  const Buffer buffer(device(), "buffer", 64, Memory::device);
  const TexelBuffer texels(device(), buffer, Format::r32_uint);
  CommandList commands(device(), "wrong");
  const AddParams params;
  const auto message = [&](std::initializer_list<Binding> bindings, std::span<const std::byte> push) {
    try {
      commands.dispatch(pipeline, bindings, push, {1, 1, 1});
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::device_or_plugin_failed);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message({bind(0, buffer)}, push_bytes(params)).find("slot 2"), std::string::npos);
  EXPECT_NE(message({bind(0, texels), bind(2, buffer)}, push_bytes(params)).find("slot 0"),
            std::string::npos);
  EXPECT_NE(message({bind(0, buffer), bind(2, buffer)}, {}).find("push constants"), std::string::npos);
}

TEST(KernelInterfaceTest, IsReadFromTheSpirv) {
  KernelDescription kernel;
  kernel.main = {"all.comp", R"(#version 460
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 8, local_size_y = 4, local_size_z = 2) in;
layout(binding = 0) uniform usamplerBuffer texels;
layout(binding = 1, r32ui) uniform writeonly uimageBuffer stored;
layout(binding = 4) uniform sampler3D volume;
layout(binding = 5, rgba8) uniform writeonly image2D picture;
layout(binding = 6, std140) uniform Table { vec4 entry[16]; } table;
layout(binding = 8) uniform usamplerBuffer left_out;
layout(push_constant, scalar) uniform Params { vec3 a; float b[3]; mat4x3 c; } params;
void main() {
  uvec3 i = gl_GlobalInvocationID;
  vec4 v = texture(volume, params.a) + table.entry[i.x & 15u] * params.b[i.y & 1u] + vec4(params.c[1], 0.0);
  imageStore(stored, int(i.x), texelFetch(texels, int(i.x)));
  imageStore(picture, ivec2(i.xy), v);
}
)"};
  const KernelInterface interface =
      reflect(compile(kernel, {.use_cache = false, .cache_folder = {}}).spirv, "all");
  using enum BindingKind;
  const std::vector<KernelInterface::Binding> expected{{0, uniform_texel_buffer, "texels"},
                                                       {1, storage_texel_buffer, "stored"},
                                                       {4, sampled_image, "volume"},
                                                       {5, storage_image, "picture"},
                                                       {6, uniform_buffer, "table"}};
  EXPECT_EQ(interface.bindings, expected);  // slot 8 is not in the kernel: nothing reads it
  EXPECT_EQ(interface.push_constant_bytes, 12u + 12u + 48u);
  EXPECT_EQ(interface.local_size, (std::array<std::uint32_t, 3>{8, 4, 2}));
}

TEST(KernelInterfaceTest, DamagedSpirvIsAnError) {
  const std::vector<std::uint32_t> empty, foreign{1, 2, 3, 4, 5},
      cut{0x07230203, 0x10500, 0, 9, 0, 0x00ff0000};
  for (const auto& words : {empty, foreign, cut})
    EXPECT_THROW((void)reflect(words, "k"), Error);
}

}  // namespace
}  // namespace brace::gpu
