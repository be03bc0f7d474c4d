#include "runtime/raycast/volume_on_device.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "runtime/raycast/packed_layout.hpp"

namespace brace {

namespace {

constexpr std::size_t kSlabBytes = std::size_t{16} << 20;

gpu::Format image_format(VoxelType type) {
  switch (type) {
    case VoxelType::uint8:
      return gpu::Format::r8_unorm;
    case VoxelType::int16:
    case VoxelType::uint16:
      return gpu::Format::r16_unorm;
    case VoxelType::float32:
      return gpu::Format::r32_float;
  }
  return gpu::Format::r8_unorm;
}

/// int16 lies on the device as value + 32768, as there is no filterable signed format that keeps -32768.
void bias_signed(std::span<std::byte> voxels) {
  for (std::size_t i = 1; i < voxels.size(); i += 2)
    voxels[i] ^= std::byte{0x80};  // high byte, little endian
}

/// The threshold of the byte-wise test in brace_is_empty: voxels up to it are invisible. A byte b exceeds the
/// threshold h when the top bit of (b & 127) + (127 - (h & 127)) says so for the lower seven bits, together
/// with b's own top bit: either of them for h < 128 (the mask w), both for h >= 128.
void describe_emptiness(BraceEyeParams& params) {
  const float highest = std::floor((params.transfer[3] - params.transfer[1]) / params.transfer[0]);
  if (highest < 0.0f) {  // nothing is empty: every sum has its top bit set
    params.texel_grid[2] = 0x80808080u;
    params.texel_grid[3] = ~0u;
    return;
  }
  const auto threshold = static_cast<std::uint32_t>(std::min(highest, 255.0f));
  params.texel_grid[2] = 0x01010101u * (127u - (threshold & 127u));
  params.texel_grid[3] = threshold < 128u ? ~0u : 0u;
}

}  // namespace

VolumeOnDevice::VolumeOnDevice(const gpu::Device& device, VolumeSource& source, VolumePathChoice choice,
                               VoxelScan* scan, const Progress& progress)
    : info_(source.info()), choice_(std::move(choice)) {
  if (choice_.path == VolumePath::packed) {
    stream_packed(device, source, scan, progress);
  } else {
    stream_to_image(device, source, scan, progress);
  }
}

void VolumeOnDevice::stream_to_image(const gpu::Device& device, VolumeSource& source, VoxelScan* scan,
                                     const Progress& progress) {
  image_ =
      gpu::Image3D(device, "volume", {info_.dims[0], info_.dims[1], info_.dims[2]}, image_format(info_.type));
  // Up to half a voxel outside the box mirroring is clamping. Lavapipe filters 8-bit images with 8-bit sums
  // where it may assume clamping or repeating, and as floats otherwise.
  sampler_ = gpu::Sampler(device, "volume", gpu::Filter::linear, gpu::Address::mirror);
  device_bytes_ = info_.byte_count();
  const int slices_max = slab_slices(info_, kSlabBytes);
  std::vector<std::byte> slab;
  for (int z = 0; z < info_.dims[2];) {
    const int slices = std::min(slices_max, info_.dims[2] - z);
    slab.resize(static_cast<std::size_t>(slices) * info_.slice_bytes());
    source.read_slab(slab, z, slices);
    if (scan != nullptr) scan->add(slab);
    if (info_.type == VoxelType::int16) bias_signed(slab);
    gpu::upload(device, image_, slab, z);
    z += slices;
    if (progress) progress(static_cast<double>(z) / info_.dims[2]);
  }
}

void VolumeOnDevice::stream_packed(const gpu::Device& device, VolumeSource& source, VoxelScan* scan,
                                   const Progress& progress) {
  const PackedLayout layout(info_);
  device_bytes_ = layout.bytes();
  buffer_ = gpu::Buffer(device, "volume", layout.bytes(), gpu::Memory::device);
  const auto format = info_.type == VoxelType::float32 ? gpu::Format::r32_float : gpu::Format::r32_uint;
  texels_ = gpu::TexelBuffer(device, buffer_, format);
  std::vector<std::byte> slice(info_.slice_bytes());
  std::vector<std::uint32_t> packed(layout.slice_texels);
  for (int z = 0; z < info_.dims[2]; ++z) {
    source.read_slab(slice, z, 1);
    if (scan != nullptr) scan->add(slice);
    if (info_.type == VoxelType::int16) bias_signed(slice);
    pack_slice(layout, slice, packed);
    const auto bytes = std::as_bytes(std::span(packed));
    // Slice z lies at z + 1; the apron repeats the first and the last one.
    const auto put = [&](int at) {
      gpu::upload(device, buffer_, bytes, static_cast<std::uint64_t>(at) * bytes.size());
    };
    put(z + 1);
    if (z == 0) put(0);
    if (z + 1 == info_.dims[2]) put(z + 2);
    if (progress) progress(static_cast<double>(z + 1) / info_.dims[2]);
  }
}

std::vector<std::pair<std::string, std::string>> VolumeOnDevice::defines() const {
  if (choice_.path == VolumePath::sampler) return {};
  switch (info_.type) {
    case VoxelType::uint8:
      return {{"BRACE_VOLUME_PACKED_8", "1"}};
    case VoxelType::int16:
    case VoxelType::uint16:
      return {{"BRACE_VOLUME_PACKED_16", "1"}};
    case VoxelType::float32:
      return {{"BRACE_VOLUME_TEXELS_32", "1"}};
  }
  return {};
}

gpu::Binding VolumeOnDevice::binding(std::uint32_t slot) const {
  return choice_.path == VolumePath::sampler ? gpu::bind(slot, image_, sampler_) : gpu::bind(slot, texels_);
}

void VolumeOnDevice::describe(BraceEyeParams& params) const {
  const bool is_normalised = choice_.path == VolumePath::sampler && info_.type != VoxelType::float32;
  const float full_scale = info_.type == VoxelType::uint8 ? 255.0f : 65535.0f;
  params.value[0] = is_normalised ? full_scale : 1.0f;
  params.value[1] = info_.type == VoxelType::int16 ? -32768.0f : 0.0f;
  if (choice_.path != VolumePath::packed) return;
  const PackedLayout layout(info_);
  params.texel_grid[0] = layout.row_texels;
  params.texel_grid[1] = static_cast<std::uint32_t>(layout.slice_texels);
  if (info_.type == VoxelType::uint8) describe_emptiness(params);
}

}  // namespace brace
