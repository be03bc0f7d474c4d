#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "runtime/gpu/memory.hpp"
#include "runtime/gpu/pipeline.hpp"

namespace brace::gpu {

/// A resource put into a binding slot. Made with bind(); the resource must live until the commands are done.
struct Binding {
  std::uint32_t slot = 0;
  VkBuffer_T* buffer = nullptr;  // storage or uniform buffer
  std::uint64_t offset_bytes = 0, size_bytes = 0;
  VkBufferView_T* texels = nullptr;  // texel buffer
  VkImageView_T* image = nullptr;    // image, with or without sampler
  VkSampler_T* sampler = nullptr;
};

inline Binding bind(std::uint32_t slot, const Buffer& buffer) {
  return {slot, buffer.handle(), 0, buffer.size_bytes()};
}
/// A part of a buffer; offset a multiple of limits().storage_buffer_offset_alignment_bytes.
inline Binding bind(std::uint32_t slot, const Buffer& buffer, std::uint64_t offset_bytes,
                    std::uint64_t size_bytes) {
  return {slot, buffer.handle(), offset_bytes, size_bytes};
}
inline Binding bind(std::uint32_t slot, const TexelBuffer& view) {
  return {slot, nullptr, 0, 0, view.handle()};
}
inline Binding bind(std::uint32_t slot, const Image& image) {
  return {slot, nullptr, 0, 0, nullptr, image.view()};
}
inline Binding bind(std::uint32_t slot, const Image& image, const Sampler& sampler) {
  return {slot, nullptr, 0, 0, nullptr, image.view(), sampler.handle()};
}

/// Device time of one begin_timing/end_timing pair.
struct Timing {
  std::string name;
  std::int64_t device_ns = 0;
};

/// Recorded work for the device. Record once and submit as often as wanted, or reset() and record anew; no
/// memory is allocated per dispatch once warm. Commands between two barriers may run in any order.
class CommandList {
 public:
  static constexpr std::uint32_t timings_max = 64;  // per recording

  CommandList() = default;
  CommandList(const Device& device, std::string name);
  ~CommandList();
  CommandList(CommandList&& other) noexcept { swap(other); }
  CommandList& operator=(CommandList&& other) noexcept {
    CommandList(std::move(other)).swap(*this);
    return *this;
  }

  /// Forgets what was recorded.
  void reset();

  /// Binds and runs `groups` work-groups. Slots that the kernel does not use are ignored, so one binding list
  /// serves every variant of a kernel; a slot that it uses and nobody bound is a programming error, and so is
  /// a push constant block of another size than the kernel's.
  void dispatch(const ComputePipeline& pipeline, std::span<const Binding> bindings,
                std::span<const std::byte> push_constants, std::array<std::uint32_t, 3> groups);
  void dispatch(const ComputePipeline& pipeline, std::initializer_list<Binding> bindings,
                std::span<const std::byte> push_constants, std::array<std::uint32_t, 3> groups) {
    dispatch(pipeline, std::span(bindings.begin(), bindings.size()), push_constants, groups);
  }

  /// Everything recorded before is done and visible to everything after, the host's reads included.
  void barrier();

  void copy(const Buffer& from, const Buffer& to, std::uint64_t size_bytes,
            std::uint64_t from_offset_bytes = 0, std::uint64_t to_offset_bytes = 0);
  /// Sets `size_bytes` (0: all) bytes to a repeated 32-bit word; offset and size multiples of 4.
  void fill(const Buffer& to, std::uint32_t word, std::uint64_t offset_bytes = 0,
            std::uint64_t size_bytes = 0);

  /// Device time from here to the matching end_timing. Pairs may nest; names need not be unique.
  void begin_timing(std::string name);
  void end_timing();

  VkCommandBuffer_T* handle() const { return commands_; }

  /// The command buffer in the recording state, for commands that others put in (native stages). They may
  /// leave any bound state behind; the next dispatch binds its own.
  VkCommandBuffer_T* hand_out();

 private:
  friend const std::vector<Timing>& submit_and_wait(CommandList& commands);
  void swap(CommandList& other) noexcept;
  void ensure_recording();
  void ensure_submittable();

  DeviceContext* context_ = nullptr;
  std::string name_;
  VkCommandPool_T* pool_ = nullptr;
  VkCommandBuffer_T* commands_ = nullptr;
  VkQueryPool_T* queries_ = nullptr;
  VkFence_T* fence_ = nullptr;
  enum class State { empty, recording, closed } state_ = State::empty;
  VkPipeline_T* bound_pipeline_ = nullptr;
  std::vector<Timing> timings_;              // in the order of begin_timing
  std::vector<std::uint32_t> open_timings_;  // stack of indices into timings_
};

/// Runs the recorded commands and waits for them. Returns a timing per begin_timing, in order; the reference
/// is valid until the next recording or submission. Throws device_error when the device is lost.
const std::vector<Timing>& submit_and_wait(CommandList& commands);

/// Sum of all timings, ns.
std::int64_t total_ns(std::span<const Timing> timings);

/// Sum of the timings of this name, ns.
std::int64_t device_ns(std::span<const Timing> timings, std::string_view name);

/// The bytes of a parameter block (a struct of a *_params.h header) as push constants.
template <typename Params>
std::span<const std::byte> push_bytes(const Params& params) {
  static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) <= 128);
  return std::as_bytes(std::span(&params, 1));
}

}  // namespace brace::gpu
