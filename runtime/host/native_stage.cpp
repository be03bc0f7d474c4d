#include "runtime/host/native_stage.hpp"

#include <utility>

#include "base/error.hpp"
#include "runtime/host/plugin_library.hpp"

namespace brace {

NativeStage::NativeStage(const PipelineStage& stage)
    : library_(stage.stage.library),
      descriptor_(stage.stage.native),
      id_(stage.stage.id()),
      origin_(stage.stage.origin.empty() ? "built in" : stage.stage.origin.string()) {
  BRACE_CHECK(descriptor_ != nullptr && stage.values.size() == descriptor_->param_count);
  try {
    self_ = descriptor_->create(stage.values.data(), static_cast<std::uint32_t>(stage.values.size()));
  } catch (...) {
    fail("create", "an exception thrown across the C interface");
  }
  if (self_ == nullptr) fail("create", "null");
}

NativeStage::~NativeStage() {
  if (self_ == nullptr) return;
  deactivate();
  descriptor_->destroy(self_);
}

void NativeStage::swap(NativeStage& other) noexcept {
  std::swap(library_, other.library_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(id_, other.id_);
  std::swap(origin_, other.origin_);
  std::swap(self_, other.self_);
  std::swap(active_, other.active_);
}

void NativeStage::fail(const char* what, const std::string& found) const {
  std::string said;
  if (self_ != nullptr && descriptor_->last_error != nullptr) {
    const char* text = descriptor_->last_error(self_);
    if (text != nullptr && *text != '\0') said = fmt::format(": {}", text);
  }
  throw device_error("{}: stage {} failed in {}; expected BRACE_OK; found {}{}", origin_, id_, what, found,
                     said);
}

template <typename Call>
void NativeStage::checked(const char* what, Call&& call) const {
  BRACE_CHECK(self_ != nullptr);
  brace_result result = BRACE_ERROR;
  try {
    result = call();
  } catch (...) {
    fail(what, "an exception thrown across the C interface");
  }
  if (result != BRACE_OK) fail(what, result_name(result));
}

template <typename Table>
const Table& NativeStage::table(brace_kind kind) const {
  BRACE_CHECK(descriptor_ != nullptr && descriptor_->kind == kind);
  return *static_cast<const Table*>(descriptor_->functions);
}

void NativeStage::activate(const brace_activation& activation) {
  BRACE_CHECK(!active_);
  if (descriptor_->activate != nullptr) {
    checked("activate", [&] { return descriptor_->activate(self_, &activation); });
  }
  active_ = true;
}

void NativeStage::activate() {
  brace_activation nothing{};
  nothing.struct_size = sizeof nothing;
  activate(nothing);
}

void NativeStage::deactivate() {
  if (!active_) return;
  active_ = false;
  if (descriptor_->deactivate != nullptr) descriptor_->deactivate(self_);
}

void NativeStage::open(const brace_cast_frame& frame) const {
  BRACE_CHECK(active_);
  checked("open", [&] { return table<brace_rays_functions>(BRACE_KIND_RAYS).open(self_, &frame); });
}

void NativeStage::close(const brace_cast_frame& frame) const {
  BRACE_CHECK(active_);
  checked("close", [&] { return table<brace_rays_functions>(BRACE_KIND_RAYS).close(self_, &frame); });
}

bool NativeStage::casts_on_host() const {
  return table<brace_cast_functions>(BRACE_KIND_CAST).execute != nullptr;
}

void NativeStage::cast(const brace_cast_frame& frame) const {
  BRACE_CHECK(active_);
  const auto& functions = table<brace_cast_functions>(BRACE_KIND_CAST);
  if (functions.execute != nullptr)
    return checked("execute", [&] { return functions.execute(self_, &frame); });
  checked("record", [&] { return functions.record(self_, &frame); });
}

bool NativeStage::skips_on_host() const {
  return table<brace_skip_functions>(BRACE_KIND_SKIP).execute_update != nullptr;
}

std::uint32_t NativeStage::block_edge_voxels() const {
  BRACE_CHECK(active_);
  const std::uint32_t edge = table<brace_skip_functions>(BRACE_KIND_SKIP).block_edge_voxels(self_);
  if (edge >= 1 && edge <= 64) return edge;
  throw device_error("{}: stage {} failed in block_edge_voxels; expected 1 to 64; found {}", origin_, id_,
                     edge);
}

void NativeStage::update_skip(const brace_skip_frame& frame) const {
  BRACE_CHECK(active_);
  const auto& functions = table<brace_skip_functions>(BRACE_KIND_SKIP);
  if (functions.execute_update != nullptr) {
    return checked("execute_update", [&] { return functions.execute_update(self_, &frame); });
  }
  checked("record_update", [&] { return functions.record_update(self_, &frame); });
}

void NativeStage::stereo(const brace_stereo_frame& frame) const {
  BRACE_CHECK(active_);
  checked("record", [&] { return table<brace_stereo_functions>(BRACE_KIND_STEREO).record(self_, &frame); });
}

void NativeStage::warp(const brace_warp_frame& frame) const {
  BRACE_CHECK(active_);
  checked("record", [&] { return table<brace_warp_functions>(BRACE_KIND_WARP).record(self_, &frame); });
}

const brace_predict_functions& NativeStage::predict_functions() const {
  return table<brace_predict_functions>(BRACE_KIND_PREDICT);
}

const brace_control_functions& NativeStage::control_functions() const {
  return table<brace_control_functions>(BRACE_KIND_CONTROL);
}

const brace_cost_functions& NativeStage::cost_functions() const {
  return table<brace_cost_functions>(BRACE_KIND_COST);
}

}  // namespace brace
