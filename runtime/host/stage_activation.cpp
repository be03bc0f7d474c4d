#include "runtime/host/stage_activation.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/gpu/native_handles.hpp"

namespace brace {

namespace {

brace_voxel_type voxel_type(VoxelType type) {
  switch (type) {
    case VoxelType::uint8:
      return BRACE_VOXEL_UINT8;
    case VoxelType::int16:
      return BRACE_VOXEL_INT16;
    case VoxelType::uint16:
      return BRACE_VOXEL_UINT16;
    case VoxelType::float32:
      return BRACE_VOXEL_FLOAT32;
  }
  return BRACE_VOXEL_UINT8;
}

}  // namespace

brace_pose to_abi(const Pose& pose) {
  const glm::dquat& q = pose.orientation;
  return {{q.x, q.y, q.z, q.w}, {pose.position.x, pose.position.y, pose.position.z}};
}

Pose from_abi(const brace_pose& pose) {
  const double* q = pose.orientation_xyzw;
  return {glm::dquat(q[3], q[0], q[1], q[2]), {pose.position_m[0], pose.position_m[1], pose.position_m[2]}};
}

brace_buffer_range buffer_range(const gpu::Buffer& buffer, std::uint64_t offset_bytes,
                                std::uint64_t size_bytes) {
  const std::uint64_t size = size_bytes == 0 ? buffer.size_bytes() - offset_bytes : size_bytes;
  BRACE_CHECK(offset_bytes + size <= buffer.size_bytes());
  return {buffer.handle(), offset_bytes, size,
          buffer.is_mapped() ? buffer.mapped().data() + offset_bytes : nullptr};
}

StageActivation::StageActivation(const ActivationInput& input) : open_(input.open_volume) {
  activation_.struct_size = sizeof activation_;
  activation_.eye_width_px = input.eye_width_px;
  activation_.eye_height_px = input.eye_height_px;
  activation_.ray_count_max = input.ray_count_max;
  activation_.step_units = input.step_units;
  activation_.shading = input.shading;
  activation_.shading_samples = input.shading_samples;
  activation_.shading_step_units = input.shading_step_units;
  for (int axis = 0; axis < 3; ++axis)
    activation_.shading_light[axis] = input.shading_light[axis];
  if (input.eye_width_px != 0) {
    activation_.eye_image_format = BRACE_FORMAT_RGBA8_PREMULTIPLIED;
    activation_.eye_depth_format = BRACE_FORMAT_R32_FLOAT;
  }
  if (input.device != nullptr) {
    const gpu::NativeHandles handles = gpu::native_handles(*input.device);
    vulkan_ = {sizeof vulkan_,
               handles.api_version,
               handles.instance,
               handles.physical_device,
               handles.device,
               handles.queue_family_index,
               handles.get_instance_proc_addr};
    activation_.vulkan = &vulkan_;
  }
  if (input.volume != nullptr) describe_volume(input);
  if (input.transfer != nullptr) {
    static_assert(sizeof(std::array<double, 4>) == 4 * sizeof(double));
    transfer_ = {sizeof transfer_, static_cast<std::uint32_t>(input.transfer->entries.size()),
                 input.transfer->range.min, input.transfer->range.max,
                 input.transfer->entries.front().data()};
    activation_.transfer = &transfer_;
  }
}

void StageActivation::describe_volume(const ActivationInput& input) {
  const VolumeInfo& info = *input.volume;
  const double unit = voxel_length(info);
  volume_.struct_size = sizeof volume_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    volume_.dims[axis] = static_cast<std::uint32_t>(info.dims[axis]);
    volume_.spacing[axis] = info.spacing[axis] / unit;
  }
  volume_.type = voxel_type(info.type);
  volume_.metres_per_unit = input.metres_per_unit;
  volume_.world_from_volume = to_abi(input.world_from_volume);
  volume_.value_scale = 1.0;  // readers apply the file's own scale: voxels are in the data's units
  volume_.read_slices = read_slices;
  volume_.host_context = this;
  volume_.layout = input.layout;
  volume_.texels = input.volume_on_device.texels;
  volume_.image = input.volume_on_device.image;
  volume_.sampler = input.volume_on_device.sampler;
  activation_.volume = &volume_;
}

brace_result StageActivation::read_slices(const brace_volume* volume, std::uint32_t z_begin,
                                          std::uint32_t z_count, void* voxels, std::uint64_t size_bytes) {
  if (volume == nullptr || voxels == nullptr) return BRACE_INVALID_ARGUMENT;
  auto& self = *static_cast<StageActivation*>(volume->host_context);
  const std::uint32_t depth = self.volume_.dims[2];
  if (z_count == 0 || z_begin >= depth || z_count > depth - z_begin) return BRACE_INVALID_ARGUMENT;
  try {
    if (!self.open_) return BRACE_UNSUPPORTED;
    if (!self.source_ || self.source_->next_z() > static_cast<int>(z_begin)) self.source_ = self.open_();
    if (size_bytes != self.source_->info().slice_bytes() * z_count) return BRACE_INVALID_ARGUMENT;
    self.read(z_begin, z_count, voxels);
    return BRACE_OK;
  } catch (...) {
    self.read_error_ = std::current_exception();
    return BRACE_ERROR;
  }
}

void StageActivation::read(std::uint32_t z_begin, std::uint32_t z_count, void* voxels) {
  const std::size_t slice_bytes = source_->info().slice_bytes();
  std::vector<std::byte> skipped;
  while (source_->next_z() < static_cast<int>(z_begin)) {
    skipped.resize(slice_bytes);
    source_->read_slab(skipped, source_->next_z(), 1);
  }
  source_->read_slab(std::span(static_cast<std::byte*>(voxels), slice_bytes * z_count),
                     static_cast<int>(z_begin), static_cast<int>(z_count));
}

void StageActivation::rethrow_read_error() const {
  if (read_error_) std::rethrow_exception(read_error_);
}

}  // namespace brace
