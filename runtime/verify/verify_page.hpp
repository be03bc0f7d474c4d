#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/verify/verify.hpp"

namespace brace {

struct VerifyReport {
  std::vector<Claim> claims;
  VerifyFigures figures;
  std::string device;   // name of the Vulkan device
  std::string version;  // of Brace
  double seconds = 0.0;

  std::size_t failed() const;
};

/// {"passed", "claims": [{"group", "claim", "figure", "unit", "low", "high", "passed"}], "device",
/// "seconds"}; a bound without an end and a figure that is not finite are null.
std::string to_json(const VerifyReport& report);

/// One self-contained file in the style of the run report; `page_folder` holds report.css.
void write_verify_page(const std::filesystem::path& path, const VerifyReport& report,
                       const std::filesystem::path& page_folder);

}  // namespace brace
