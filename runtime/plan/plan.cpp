#include "runtime/plan/plan.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "base/suggest.hpp"
#include "runtime/plan/plan_rules.hpp"
#include "runtime/session/mab_level_items.hpp"
#include "runtime/session/plan_keys.hpp"

namespace brace {

namespace {

bool contains(const std::vector<std::string>& list, const std::string& one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

/// The pipeline as it stands while items are tried one after the other.
class Planner {
 public:
  Planner(const SessionReader& read, PlanTrials& trials, const PlanRules& rules, const Session& given)
      : read_(read),
        trials_(trials),
        rules_(rules),
        asked_for_(given.plan.leave_out),
        whole_(without({})),
        current_(whole_),
        trial_(trials.replay_briefly(whole_)) {}

  const PlanTrial& trial() const { return trial_; }
  const Session& current() const { return current_; }
  const std::vector<std::string>& left_out() const { return left_out_; }

  /// Tries to do without one more item and keeps it so if nothing is lost.
  PlanLine consider(const std::string& item) {
    PlanLine line{.item = item, .stage = stage_text(current_, item), .figure = {}, .saving_ms = {}};
    std::vector<std::string> items = left_out_;
    items.push_back(item);
    const Session tried_session = without(items);
    const ErrorVerdict error = rules_.error_without(item, whole_, tried_session, trials_);
    if (!error.tolerable) {
      line.verdict = PlanVerdict::kept;
      line.figure = error.figure;
      return line;
    }
    const PlanTrial tried = trials_.replay_briefly(tried_session);
    line.saving_ms = trial_.frame_ms - tried.frame_ms;
    const bool costs_nothing = *line.saving_ms >= rules_.least_saving_ms(trial_);
    line.verdict = costs_nothing ? PlanVerdict::left_out : PlanVerdict::kept;
    for (const std::string& part : {rules_.fact_behind(item), error.figure})
      if (!part.empty()) line.figure += part + "; ";
    line.figure += fmt::format("{:.3f} ms with, {:.3f} without", trial_.frame_ms, tried.frame_ms);
    if (costs_nothing) {
      left_out_ = items;
      current_ = tried_session;
      trial_ = tried;
    }
    return line;
  }

 private:
  /// The session without what the user left out and these; what does nothing is left out as well.
  Session without(const std::vector<std::string>& items) const {
    std::string words = "idle";
    for (const auto* list : {&asked_for_, &items})
      for (const std::string& item : *list)
        words += "," + item;
    return read_({{"plan.leave_out", words}});
  }

  const SessionReader& read_;
  PlanTrials& trials_;
  const PlanRules& rules_;
  std::vector<std::string> asked_for_;
  Session whole_;    // nothing tried yet: what pictures are held against
  Session current_;  // without what was left out so far
  PlanTrial trial_;
  std::vector<std::string> left_out_;
};

/// Whether it can be tried now: neither gone with another item nor the last level of the atlas.
bool stands_alone(const Session& current, const std::string& item) {
  return has_item(current, item) &&
         !(mab_level_of(item) && current.pipeline.at("rays").value("levels") == 1.0);
}

/// Items that are tried: the session has them and nobody asked to keep them.
std::vector<std::string> items_to_try(const Session& given) {
  std::vector<std::string> items;
  for (const std::string& item : tried_items())
    if (has_item(given, item) && !contains(given.plan.keep, item)) items.push_back(item);
  return items;
}

PlanLine line_without_trial(const Session& given, const Session& planned, const std::string& item,
                            const PlanRules& rules) {
  PlanLine line{.item = item, .stage = stage_text(given, item), .figure = {}, .saving_ms = {}};
  if (contains(given.plan.leave_out, item)) {
    line.verdict = PlanVerdict::left_out;
    line.figure = "asked for";
  } else if (contains(tried_items(), item)) {
    const bool has = has_item(given, item), asked_for = contains(given.plan.keep, item);
    line.verdict = has && (asked_for || has_item(planned, item)) ? PlanVerdict::kept : PlanVerdict::absent;
    line.figure = asked_for                           ? "asked for"
                  : !has                              ? "the session has none"
                  : line.verdict == PlanVerdict::kept ? "the only level"
                                                      : "gone with rays/mab";
  } else {
    rules.judge_display(given, line);
  }
  return line;
}

}  // namespace

const char* to_string(PlanVerdict verdict) {
  switch (verdict) {
    case PlanVerdict::kept:
      return "kept";
    case PlanVerdict::left_out:
      return "left out";
    case PlanVerdict::idle:
      return "idle";
    case PlanVerdict::absent:
      return "absent";
  }
  return "";
}

std::vector<LeftOut> Plan::reasons() const {
  std::vector<LeftOut> left;
  for (const PlanLine& line : lines)
    if (line.verdict == PlanVerdict::left_out) left.push_back({line.item, "not needed here: " + line.figure});
  return left;
}

Plan make_plan(const SessionReader& read, PlanTrials& trials, const PlanThresholds& thresholds) {
  const Session given = read({});
  SceneFacts facts = scene_facts(given, make_headset(given, trials.data_folder()),
                                 load_head_trace(given.trace, trials.data_folder()));
  facts.volume = trials.look_at_volume(given);
  const PlanRules rules(std::move(facts), thresholds);
  Plan plan;
  plan.facts = rules.facts();
  plan.cost = given.clock.cost;
  plan.given_ms = trials.replay_briefly(given).frame_ms;
  Planner planner(read, trials, rules, given);
  std::map<std::string, PlanLine> lines;
  // What has been left out changes what the rest is worth: what stayed is tried once more.
  for (bool again = true; again;) {
    const std::size_t before = planner.left_out().size();
    for (const std::string& item : items_to_try(given))
      if (!contains(planner.left_out(), item) && stands_alone(planner.current(), item))
        lines[item] = planner.consider(item);
    again = planner.left_out().size() > before;
  }
  plan.leave_out = given.plan.leave_out;
  plan.leave_out.insert(plan.leave_out.end(), planner.left_out().begin(), planner.left_out().end());
  plan.planned_ms = planner.trial().frame_ms;
  for (const std::string& item : plan_items()) {
    const auto level = mab_level_of(item);
    if (level && *level >= static_cast<int>(given.plan.mab_scales.size())) continue;
    plan.lines.push_back(lines.contains(item) ? lines.at(item)
                                              : line_without_trial(given, planner.current(), item, rules));
  }
  return plan;
}

Overrides settings_of(const Plan& plan) {
  return {{"plan.leave_out", plan.leave_out.empty() ? "idle" : "idle," + join(plan.leave_out, ",")}};
}

}  // namespace brace
