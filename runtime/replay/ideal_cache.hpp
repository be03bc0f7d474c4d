#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "runtime/replay/panel_display.hpp"

namespace brace {

/// Ideal pictures that have been made, for vsyncs and series that want the same ones again: they depend on
/// where the head truly is, and not on the stages that are compared. In memory, for one replay.
class IdealCache {
 public:
  /// The newest picture is always kept, older ones as far as they fit. Those that came first stay, as a later
  /// series asks in the same order.
  explicit IdealCache(std::uint64_t bytes_max) : bytes_max_(bytes_max) {}

  /// Null if there is none of this key.
  std::shared_ptr<const PanelPair> find(const std::string& key) const;
  void keep(const std::string& key, std::shared_ptr<const PanelPair> pictures);

 private:
  std::uint64_t bytes_max_, bytes_ = 0;
  std::map<std::string, std::shared_ptr<const PanelPair>> pictures_;
  std::string newest_key_;
  std::shared_ptr<const PanelPair> newest_;
};

}  // namespace brace
