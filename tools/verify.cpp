#include <algorithm>
#include <chrono>

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "runtime/gpu/device.hpp"
#include "runtime/verify/verify_page.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

void print_claim(const Claim& claim) {
  fmt::print("[{}] {}: {}: {}{}{}  (bound {})\n", claim.passed ? " ok " : "FAIL", claim.group, claim.claim,
             figure_text(claim.figure), claim.unit.empty() ? "" : " ", claim.unit, to_string(claim.bound));
  std::fflush(stdout);
}

/// The groups asked for, all of them if none is.
std::vector<VerifyGroup> chosen_groups(const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  for (const VerifyGroup& group : verify_groups())
    names.push_back(group.name);
  for (const std::string& name : wanted) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw input_error("verify: there is no group '{}'{}; accepted: {}", name, did_you_mean(name, names),
                        join(names));
    }
  }
  std::vector<VerifyGroup> chosen;
  for (const VerifyGroup& group : verify_groups())
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), group.name) != wanted.end())
      chosen.push_back(group);
  return chosen;
}

}  // namespace

int verify_command(const VerifyCommand& command) {
  const std::vector<VerifyGroup> groups = chosen_groups(command.groups);
  if (!command.out.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(command.out, failed);
    if (failed) throw input_error("--out {}: cannot be made: {}", command.out, failed.message());
  }
  const auto begin = std::chrono::steady_clock::now();
  const gpu::Device device({.select = command.gpu});
  Caster caster(device, data_folder());
  const VerifySubjects subjects = product_subjects(caster, data_folder());
  VerifyReport report;
  report.device = device.info().name;
  report.version = BRACE_VERSION;
  for (const VerifyGroup& group : groups) {
    Claims claims(group.name, command.json ? Claims::Listener() : print_claim);
    group.check(subjects, claims, report.figures);
    for (Claim& claim : claims.take())
      report.claims.push_back(std::move(claim));
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!command.out.empty())
    write_verify_page(std::filesystem::path(command.out) / "report.html", report, data_folder() / "report");
  if (command.json) {
    fmt::print("{}\n", to_json(report));
  } else {
    fmt::print("{} claims, {} hold, {} failed, {:.1f} s on {}\n", report.claims.size(),
               report.claims.size() - report.failed(), report.failed(), report.seconds, report.device);
  }
  return static_cast<int>(report.failed() == 0 ? ExitCode::done : ExitCode::check_failed);
}

}  // namespace brace
