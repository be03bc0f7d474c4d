#include "runtime/gpu/memory.hpp"

#include <cmath>
#include <random>
#include <vector>

#include "gpu/gpu_fixture.hpp"
#include "runtime/gpu/commands.hpp"

namespace brace::gpu {
namespace {

using MemoryRoom = GpuTest;

std::vector<std::uint32_t> random_words(std::size_t count) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> words(count);
  for (std::uint32_t& word : words)
    word = static_cast<std::uint32_t>(random());
  return words;
}

TEST_F(MemoryRoom, TransfersRoundTripThroughStagingSlabs) {
  std::string reason;
  const std::unique_ptr<Device> staged =
      open({.select = "", .validation = true, .force_staging = true}, reason);
  const auto words = random_words((40u << 20) / 4 + 3);  // more than two slabs
  const Buffer buffer(*staged, "buffer", words.size() * 4 + 16, Memory::device);
  EXPECT_FALSE(buffer.is_mapped());
  upload_values<std::uint32_t>(*staged, buffer, words, 8);
  std::vector<std::uint32_t> back(words.size());
  download_values<std::uint32_t>(*staged, buffer, back, 8);
  EXPECT_EQ(back, words);
  EXPECT_TRUE(staged->validation_messages().empty());
}

TEST_F(MemoryRoom, TransfersRoundTripThroughMappedMemory) {
  const auto words = random_words(1000);
  for (const Memory memory : {Memory::device, Memory::upload, Memory::readback}) {
    const Buffer buffer(device(), "buffer", 4000, memory);
    upload_values<std::uint32_t>(device(), buffer, words);
    std::vector<std::uint32_t> back(10);
    download_values<std::uint32_t>(device(), buffer, back, 3960);
    EXPECT_TRUE(std::equal(back.begin(), back.end(), words.end() - 10));
  }
}

TEST_F(MemoryRoom, ImagesRoundTripWholeAndBySlices) {
  std::vector<std::uint32_t> words = random_words(300 * 200 * 100);  // 24 MB: more than one slab
  const Image3D image(device(), "image", {300, 200, 100}, Format::rgba8_unorm);
  upload(device(), image, std::as_bytes(std::span(words)));
  std::vector<std::uint32_t> back(words.size());
  download(device(), image, std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, words);

  std::fill(words.begin() + 300 * 200 * 98, words.end(), 17u);
  upload(device(), image, std::as_bytes(std::span(words)).subspan(300 * 200 * 98 * 4), 98);
  download(device(), image, std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, words);
}

TEST_F(MemoryRoom, SamplerInterpolatesLinearlyAndClamps) {
  KernelDescription kernel;
  kernel.main = {"sample.comp", R"(#version 460
layout(local_size_x = 8) in;
layout(binding = 0) uniform sampler2D picture;
layout(binding = 1, std430) writeonly buffer Out { float value[]; } result;
void main() {
  uint i = gl_GlobalInvocationID.x;
  result.value[i] = textureLod(picture, vec2((float(i) - 1.0) / 4.0, 0.5), 0.0).r;
}
)"};
  const ComputePipeline pipeline = make_pipeline(device(), kernel);
  const Image2D image(device(), "row", 2, 1, Format::r32_float);
  const float texels[] = {1.0f, 3.0f};  // centres at u = 0.25 and 0.75
  upload(device(), image, std::as_bytes(std::span(texels)));
  const Buffer out(device(), "out", 32, Memory::readback);
  const auto run = [&](Filter filter, Address address) {
    const Sampler sampler(device(), "sampler", filter, address);
    CommandList commands(device(), "sample");
    commands.dispatch(pipeline, {bind(0, image, sampler), bind(1, out)}, {}, {1, 1, 1});
    submit_and_wait(commands);
    const auto values = out.mapped_as<float>();
    return std::vector<float>(values.begin(), values.begin() + 7);  // u = -0.25, 0, 0.25 … 1.25
  };
  EXPECT_EQ(run(Filter::linear, Address::clamp_to_edge), (std::vector<float>{1, 1, 1, 2, 3, 3, 3}));
  EXPECT_EQ(run(Filter::linear, Address::clamp_to_zero), (std::vector<float>{0, 0.5, 1, 2, 3, 1.5, 0}));
}

TEST_F(MemoryRoom, TexelBuffersViewAPartAtTheAlignment) {
  KernelDescription kernel;
  kernel.main = {"texels.comp", R"(#version 460
layout(local_size_x = 8) in;
layout(binding = 0) uniform usamplerBuffer source;
layout(binding = 1, r32ui) uniform writeonly uimageBuffer result;
void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i < textureSize(source)) imageStore(result, i, texelFetch(source, i) + 1u);
}
)"};
  const ComputePipeline pipeline = make_pipeline(device(), kernel);
  const std::uint64_t step = device().limits().texel_buffer_offset_alignment_bytes;
  const Buffer in(device(), "in", 4 * step, Memory::upload);
  const Buffer out(device(), "out", 4 * step, Memory::readback);
  for (std::size_t i = 0; i < in.size_bytes(); ++i)
    in.mapped()[i] = static_cast<std::byte>(i);
  std::fill(out.mapped().begin(), out.mapped().end(), std::byte{0});
  const TexelBuffer bytes(device(), in, Format::r8_uint, step, 8);
  const TexelBuffer words(device(), out, Format::r32_uint);
  EXPECT_EQ(bytes.texels(), 8u);
  CommandList commands(device(), "texels");
  commands.dispatch(pipeline, {bind(0, bytes), bind(1, words)}, {}, {1, 1, 1});
  submit_and_wait(commands);
  for (std::uint32_t i = 0; i < 8; ++i)
    EXPECT_EQ(out.mapped_as<std::uint32_t>()[i], ((step + i) & 255) + 1);
}

TEST_F(MemoryRoom, WhatIsTooLargeIsNamed) {
  const std::uint64_t bytes = device().limits().allocation_bytes_max + 4096;
  try {
    const Buffer buffer(device(), "enormous", bytes, Memory::device);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::device_or_plugin_failed);
    EXPECT_NE(std::string(error.what()).find("enormous"), std::string::npos);
  }
  EXPECT_THROW(Image2D(device(), "wide", 1 << 20, 1, Format::r8_unorm), Error);
}

TEST_F(MemoryRoom, ResourcesMove) {
  Buffer first(device(), "first", 64, Memory::upload);
  const auto* handle = first.handle();
  Buffer second(std::move(first));
  EXPECT_FALSE(first);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(second.handle(), handle);
  second = Buffer(device(), "third", 128, Memory::upload);
  EXPECT_EQ(second.size_bytes(), 128u);
  EXPECT_EQ(second.name(), "third");
}

}  // namespace
}  // namespace brace::gpu
