#include "runtime/gpu/commands.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {
namespace {

constexpr std::size_t bindings_max = 32;  // what push descriptors guarantee

bool fits(const Binding& binding, BindingKind kind) {
  switch (kind) {
    case BindingKind::storage_buffer:
    case BindingKind::uniform_buffer:
      return binding.buffer != nullptr;
    case BindingKind::uniform_texel_buffer:
    case BindingKind::storage_texel_buffer:
      return binding.texels != nullptr;
    case BindingKind::sampled_image:
      return binding.image != nullptr && binding.sampler != nullptr;
    case BindingKind::storage_image:
      return binding.image != nullptr;
  }
  return false;
}

// The resource of each slot the kernel uses, as Vulkan wants it; fixed arrays, so that nothing is allocated.
struct DescriptorWrites {
  VkWriteDescriptorSet writes[bindings_max];
  VkDescriptorBufferInfo buffers[bindings_max];
  VkDescriptorImageInfo images[bindings_max];
  VkBufferView texels[bindings_max];
  std::uint32_t count = 0;

  void add(const KernelInterface::Binding& slot, const Binding& binding) {
    const std::uint32_t i = count++;
    buffers[i] = {binding.buffer, binding.offset_bytes, binding.size_bytes};
    images[i] = {binding.sampler, binding.image, VK_IMAGE_LAYOUT_GENERAL};
    texels[i] = binding.texels;
    writes[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[i].dstBinding = slot.slot;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = to_vk(slot.kind);
    writes[i].pBufferInfo = &buffers[i];
    writes[i].pImageInfo = &images[i];
    writes[i].pTexelBufferView = &texels[i];
  }
};

void check_binding(const DeviceContext& context, const ComputePipeline& pipeline,
                   const KernelInterface::Binding& slot, std::span<const Binding> bindings) {
  const auto found = std::find_if(bindings.begin(), bindings.end(),
                                  [&](const Binding& binding) { return binding.slot == slot.slot; });
  if (found == bindings.end())
    throw device_error("kernel {} uses slot {} ({} '{}'), but nothing is bound to it", pipeline.name(),
                       slot.slot, to_string(slot.kind), slot.name);
  if (!fits(*found, slot.kind))
    throw device_error(
        "kernel {} declares slot {} ('{}') as a {}, but another kind of resource is bound to it",
        pipeline.name(), slot.slot, slot.name, to_string(slot.kind));
  const std::uint64_t limit = slot.kind == BindingKind::storage_buffer
                                  ? context.info.limits.storage_buffer_bytes_max
                                  : context.info.limits.uniform_buffer_bytes_max;
  if (found->buffer && found->size_bytes > limit)
    throw device_error("kernel {}: slot {} ('{}') is bound to {} bytes, but a {} may have at most {}",
                       pipeline.name(), slot.slot, slot.name, found->size_bytes, to_string(slot.kind), limit);
}

}  // namespace

CommandList::CommandList(const Device& device, std::string name) : CommandList() {
  context_ = &device.context();
  name_ = std::move(name);
  const VolkDeviceTable& vk = context_->vk;
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.queueFamilyIndex = context_->queue_family;
  check_vk(vk.vkCreateCommandPool(context_->device, &pool, nullptr, &pool_), *context_, "create " + name_);
  VkCommandBufferAllocateInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  buffer.commandPool = pool_;
  buffer.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  buffer.commandBufferCount = 1;
  check_vk(vk.vkAllocateCommandBuffers(context_->device, &buffer, &commands_), *context_, "create " + name_);
  context_->name_object(VK_OBJECT_TYPE_COMMAND_BUFFER, commands_, name_);
  VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
  queries.queryCount = 2 * timings_max;
  check_vk(vk.vkCreateQueryPool(context_->device, &queries, nullptr, &queries_), *context_,
           "create " + name_);
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check_vk(vk.vkCreateFence(context_->device, &fence, nullptr, &fence_), *context_, "create " + name_);
  timings_.reserve(timings_max);
}

CommandList::~CommandList() {
  if (!context_) return;
  const VolkDeviceTable& vk = context_->vk;
  vk.vkDestroyFence(context_->device, fence_, nullptr);
  vk.vkDestroyQueryPool(context_->device, queries_, nullptr);
  vk.vkDestroyCommandPool(context_->device, pool_, nullptr);
}

void CommandList::swap(CommandList& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(name_, other.name_);
  std::swap(pool_, other.pool_);
  std::swap(commands_, other.commands_);
  std::swap(queries_, other.queries_);
  std::swap(fence_, other.fence_);
  std::swap(state_, other.state_);
  std::swap(bound_pipeline_, other.bound_pipeline_);
  std::swap(timings_, other.timings_);
  std::swap(open_timings_, other.open_timings_);
}

void CommandList::reset() {
  check_vk(context_->vk.vkResetCommandPool(context_->device, pool_, 0), *context_, "reset " + name_);
  state_ = State::empty;
}

void CommandList::ensure_recording() {
  if (state_ == State::recording) return;
  BRACE_CHECK(context_ && state_ == State::empty);  // submitted commands are fixed until reset()
  const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  check_vk(context_->vk.vkBeginCommandBuffer(commands_, &begin), *context_, "record " + name_);
  context_->vk.vkCmdResetQueryPool(commands_, queries_, 0, 2 * timings_max);
  bound_pipeline_ = nullptr;
  timings_.clear();
  open_timings_.clear();
  state_ = State::recording;
}

void CommandList::dispatch(const ComputePipeline& pipeline, std::span<const Binding> bindings,
                           std::span<const std::byte> push_constants, std::array<std::uint32_t, 3> groups) {
  ensure_recording();
  const KernelInterface& interface = pipeline.interface();
  const VolkDeviceTable& vk = context_->vk;
  if (push_constants.size() != interface.push_constant_bytes)
    throw device_error("kernel {} has {} bytes of push constants, but {} are given", pipeline.name(),
                       interface.push_constant_bytes, push_constants.size());
  for (std::size_t i = 0; i < 3; ++i)
    if (groups[i] > context_->info.limits.work_group_count_max[i])
      throw device_error("kernel {}: {} work-groups along axis {}, but at most {} are possible",
                         pipeline.name(), groups[i], i, context_->info.limits.work_group_count_max[i]);
  if (bound_pipeline_ != pipeline.handle()) {
    vk.vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle());
    bound_pipeline_ = pipeline.handle();
  }
  DescriptorWrites descriptors;
  for (const KernelInterface::Binding& slot : interface.bindings) {
    check_binding(*context_, pipeline, slot, bindings);
    descriptors.add(slot, *std::find_if(bindings.begin(), bindings.end(),
                                        [&](const Binding& binding) { return binding.slot == slot.slot; }));
  }
  if (descriptors.count > 0)
    vk.vkCmdPushDescriptorSetKHR(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout(), 0,
                                 descriptors.count, descriptors.writes);
  if (!push_constants.empty())
    vk.vkCmdPushConstants(commands_, pipeline.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                          static_cast<std::uint32_t>(push_constants.size()), push_constants.data());
  vk.vkCmdDispatch(commands_, groups[0], groups[1], groups[2]);
}

VkCommandBuffer_T* CommandList::hand_out() {
  ensure_recording();
  bound_pipeline_ = nullptr;
  return commands_;
}

void CommandList::barrier() {
  ensure_recording();
  record_full_barrier(*context_, commands_);
}

void CommandList::copy(const Buffer& from, const Buffer& to, std::uint64_t size_bytes,
                       std::uint64_t from_offset_bytes, std::uint64_t to_offset_bytes) {
  ensure_recording();
  BRACE_CHECK(from_offset_bytes + size_bytes <= from.size_bytes());
  BRACE_CHECK(to_offset_bytes + size_bytes <= to.size_bytes());
  const VkBufferCopy region{from_offset_bytes, to_offset_bytes, size_bytes};
  context_->vk.vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
}

void CommandList::fill(const Buffer& to, std::uint32_t word, std::uint64_t offset_bytes,
                       std::uint64_t size_bytes) {
  ensure_recording();
  BRACE_CHECK(offset_bytes % 4 == 0 && size_bytes % 4 == 0 && offset_bytes + size_bytes <= to.size_bytes());
  context_->vk.vkCmdFillBuffer(commands_, to.handle(), offset_bytes, size_bytes ? size_bytes : VK_WHOLE_SIZE,
                               word);
}

void CommandList::begin_timing(std::string name) {
  ensure_recording();
  BRACE_CHECK(timings_.size() < timings_max);
  const auto index = static_cast<std::uint32_t>(timings_.size());
  timings_.push_back({std::move(name), 0});
  open_timings_.push_back(index);
  if (context_->info.limits.timestamp_period_ns > 0.0)
    context_->vk.vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_, 2 * index);
}

void CommandList::end_timing() {
  BRACE_CHECK(state_ == State::recording && !open_timings_.empty());
  const std::uint32_t index = open_timings_.back();
  open_timings_.pop_back();
  if (context_->info.limits.timestamp_period_ns > 0.0)
    context_->vk.vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_,
                                      2 * index + 1);
}

const std::vector<Timing>& submit_and_wait(CommandList& commands) {
  commands.ensure_submittable();
  DeviceContext& context = *commands.context_;
  submit_commands(context, commands.commands_, commands.fence_, commands.name_);
  const auto count = static_cast<std::uint32_t>(2 * commands.timings_.size());
  const double period_ns = context.info.limits.timestamp_period_ns;
  if (count == 0 || period_ns <= 0.0) return commands.timings_;
  std::array<std::uint64_t, 2 * CommandList::timings_max> ticks;
  check_vk(context.vk.vkGetQueryPoolResults(context.device, commands.queries_, 0, count, sizeof(ticks),
                                            ticks.data(), sizeof(std::uint64_t),
                                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
           context, "read the timestamps of " + commands.name_);
  for (std::size_t i = 0; i < commands.timings_.size(); ++i)
    commands.timings_[i].device_ns =
        std::llround(static_cast<double>(ticks[2 * i + 1] - ticks[2 * i]) * period_ns);
  return commands.timings_;
}

void CommandList::ensure_submittable() {
  if (state_ == State::closed) return;
  ensure_recording();
  BRACE_CHECK(open_timings_.empty());
  record_full_barrier(*context_, commands_);  // results are visible to the host and to later submissions
  check_vk(context_->vk.vkEndCommandBuffer(commands_), *context_, "record " + name_);
  state_ = State::closed;
}

std::int64_t total_ns(std::span<const Timing> timings) {
  std::int64_t sum = 0;
  for (const Timing& timing : timings)
    sum += timing.device_ns;
  return sum;
}

std::int64_t device_ns(std::span<const Timing> timings, std::string_view name) {
  std::int64_t sum = 0;
  for (const Timing& timing : timings)
    if (timing.name == name) sum += timing.device_ns;
  return sum;
}

}  // namespace brace::gpu
