#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/plan/plan.hpp"
#include "runtime/plan/scene_facts.hpp"

namespace brace {

/// Items that are decided by trying, in the order in which they are tried: those first that change what the
/// others cost.
const std::vector<std::string>& tried_items();

/// "skip/distance_map", "integrator = pre-integrated": what an item is in a session.
std::string stage_text(const Session& session, const std::string& item);

/// Whether the picture stands doing without an item.
struct ErrorVerdict {
  bool tolerable = true;
  std::string figure;  // "" where doing without changes the picture for the better, or by no bit
};

/// Each item's rule (numerics.md, section 9) for one session.
class PlanRules {
 public:
  PlanRules(SceneFacts facts, const PlanThresholds& thresholds)
      : thresholds_(thresholds), facts_(std::move(facts)) {}

  const SceneFacts& facts() const { return facts_; }
  /// What the scene says of an item, "" where nothing.
  std::string fact_behind(const std::string& item) const;

  /// `whole` has every item yet, `without` neither this one nor those left out before it.
  ErrorVerdict error_without(const std::string& item, const Session& whole, const Session& without,
                             PlanTrials& trials) const;
  /// Milliseconds per frame below which a saving tells nothing; 0 where costs are counted.
  double least_saving_ms(const PlanTrial& trial) const;
  /// Fills verdict and figure of an item that the headset decides.
  void judge_display(const Session& given, PlanLine& line) const;

 private:
  ErrorVerdict warp_error(const Session& whole, const Session& without, PlanTrials& trials) const;
  ErrorVerdict integrator_error(const Session& whole, const Session& without, PlanTrials& trials) const;

  PlanThresholds thresholds_;
  SceneFacts facts_;
};

}  // namespace brace
