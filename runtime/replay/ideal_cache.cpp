#include "runtime/replay/ideal_cache.hpp"

namespace brace {

namespace {

std::uint64_t bytes_of(const PanelPair& pictures) {
  std::uint64_t bytes = 0;
  for (const ImageRgba8& picture : pictures)
    bytes += picture.pixels.size() * sizeof(Rgba8);
  return bytes;
}

}  // namespace

std::shared_ptr<const PanelPair> IdealCache::find(const std::string& key) const {
  if (newest_ && newest_key_ == key) return newest_;
  const auto found = pictures_.find(key);
  return found == pictures_.end() ? nullptr : found->second;
}

void IdealCache::keep(const std::string& key, std::shared_ptr<const PanelPair> pictures) {
  newest_key_ = key;
  newest_ = pictures;
  const std::uint64_t bytes = bytes_of(*pictures);
  if (bytes > bytes_max_ - bytes_) return;
  if (pictures_.emplace(key, std::move(pictures)).second) bytes_ += bytes;
}

}  // namespace brace
