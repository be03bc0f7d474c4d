#include "runtime/replay/native_skip.hpp"

namespace brace {

namespace {

SkipOptions options_of(const NativeStage& stage) {
  SkipOptions options;
  options.block_voxels = static_cast<int>(stage.block_edge_voxels());
  return options;
}

brace_transfer_table to_abi(const TransferTable& table) {
  return {sizeof(brace_transfer_table), static_cast<std::uint32_t>(table.entries.size()), table.range.min,
          table.range.max, table.entries.front().data()};
}

}  // namespace

NativeSkip::NativeSkip(SkipKernels& kernels, const SkipScene& scene, std::unique_ptr<ActiveStage> stage)
    : SkipStructure(kernels, scene, options_of(**stage)),
      stage_(std::move(stage)),
      map_(kernels.device(), grid_, "distance map of " + (*stage_)->id()) {
  map_.append(1);
  bind_map(BRACE_SKIP_MAP_DISTANCES, *map_.place(0).buffer, *map_.place(0).words);
}

WorkCounts NativeSkip::update(gpu::CommandList& commands, const TransferTable& table) {
  const gpu::Buffer& buffer = *map_.place(0).buffer;
  const NativeStage& stage = **stage_;
  const brace_transfer_table transfer = to_abi(table);
  brace_skip_frame frame{};
  frame.struct_size = sizeof frame;
  frame.block_edge_voxels = static_cast<std::uint32_t>(grid_.edge);
  std::copy(std::begin(grid_.blocks), std::end(grid_.blocks), frame.blocks);
  frame.row_bytes = grid_.row_quads() * 16;
  frame.slice_bytes = std::uint64_t{frame.row_bytes} * grid_.blocks[1];
  frame.distances = buffer_range(buffer, 0, frame.slice_bytes * grid_.blocks[2]);
  frame.transfer = &transfer;
  if (!stage.skips_on_host()) {
    frame.commands = commands.hand_out();
    stage.update_skip(frame);
    commands.barrier();
  } else if (frame.distances.mapped != nullptr) {
    stage.update_skip(frame);
  } else {
    host_map_.resize(frame.distances.size_bytes);
    frame.distances.mapped = host_map_.data();
    stage.update_skip(frame);
    gpu::upload(device(), buffer, host_map_);
  }
  WorkCounts work;
  work.skip_steps = grid_.count();
  work.bytes = frame.distances.size_bytes;
  return work;
}

}  // namespace brace
