#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace brace::gpu {

// Inside runtime/gpu only. One file per entry, named by its key. Entries appear whole (written aside, then
// renamed), so any number of processes share a folder; what is damaged reads as absent.

std::optional<std::vector<std::uint32_t>> read_cache_entry(const std::filesystem::path& folder,
                                                           const std::string& key);

/// False when the entry could not be written (read-only folder, full disk): a cache may be missing.
bool write_cache_entry(const std::filesystem::path& folder, const std::string& key,
                       std::span<const std::uint32_t> spirv);

}  // namespace brace::gpu
