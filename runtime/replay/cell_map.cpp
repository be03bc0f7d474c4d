#include "runtime/replay/cell_map.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/display/display_pipeline.hpp"
#include "runtime/replay/single_pass.hpp"

namespace brace {

namespace {

constexpr std::size_t kFloatsPerCell = 2 * 4 * 4;
static_assert(sizeof(BraceDisplayParams::old_from_new) + sizeof(BraceDisplayParams::old_from_last) ==
              kFloatsPerCell * sizeof(float));

std::uint64_t pixels_of(int width_px, int height_px) {
  return static_cast<std::uint64_t>(width_px) * static_cast<std::uint64_t>(height_px);
}

}  // namespace

CellMap::CellMap(const gpu::Device& device, int width_px, int height_px)
    : device_(device),
      width_px_(width_px),
      height_px_(height_px),
      cells_(device, "cells of pixels", pixels_of(width_px, height_px) * sizeof(std::uint32_t),
             gpu::Memory::device),
      cell_texels_(device, cells_, gpu::Format::r32_uint) {}

void CellMap::mark_cells(const CellCuts& cuts) {
  if (marked_ && marked_->bands == cuts.bands && marked_->columns_in_band == cuts.columns_in_band) return;
  std::vector<std::uint32_t> cells(pixels_of(width_px_, height_px_));
  for (int cell = 0; cell < cuts.columns * cuts.rows; ++cell) {
    const CastArea area = rays_of(cuts.area(cell), {0, 0, width_px_, height_px_});
    for (int y = area.y; y < area.y + area.height; ++y)
      std::fill_n(cells.begin() + y * width_px_ + area.x, area.width, static_cast<std::uint32_t>(cell));
  }
  gpu::upload_values<std::uint32_t>(device_, cells_, cells);
  marked_ = cuts;
}

void CellMap::set(const CellCuts& cuts, std::span<const Pose> world_from_old_eye, const ScanEye& new_eye) {
  BRACE_CHECK(world_from_old_eye.size() == static_cast<std::size_t>(cuts.columns * cuts.rows));
  mark_cells(cuts);
  transforms_.resize(world_from_old_eye.size() * kFloatsPerCell);
  float* to = transforms_.data();
  for (const Pose& old_eye : world_from_old_eye) {
    BraceDisplayParams params{};
    set_poses(params, old_eye, new_eye);
    for (const auto* rows : {&params.old_from_new, &params.old_from_last})
      for (const float(&row)[4] : *rows)
        to = std::copy(std::begin(row), std::end(row), to);
  }
  const std::uint64_t bytes = transforms_.size() * sizeof(float);
  if (poses_.size_bytes() != bytes)
    poses_ = gpu::Buffer(device_, "poses of cells", bytes, gpu::Memory::upload);
  gpu::upload_values<float>(device_, poses_, transforms_);
}

std::array<gpu::Binding, 2> CellMap::bindings() const {
  return {gpu::bind(DisplaySlot::cell_of_pixel, cell_texels_), gpu::bind(DisplaySlot::cell_poses, poses_)};
}

}  // namespace brace
