#include "runtime/conformance/conformance.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "runtime/conformance/suite.hpp"

namespace brace {

bool Suite::clause(const std::string& name, const std::function<std::string()>& check) {
  ClauseResult result{name, true, ""};
  try {
    result.figure = check();
  } catch (const Broken& broken) {
    result.passed = false;
    result.figure = broken.what();
  } catch (const Error& error) {
    result.passed = false;
    result.figure = error.what();
  }
  if (on_clause_) on_clause_(result);
  results_.push_back(std::move(result));
  return results_.back().passed;
}

void Suite::prepare(const std::string& name, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    const std::string found = error.what();
    clause(name, [&]() -> std::string { throw Broken(found); });
  }
}

namespace {

std::string lifecycle(Subject& subject, const std::vector<double>& values) {
  for (int i = 0; i < 2; ++i) {
    const Life life(subject, values);
    (void)subject.use();
  }
  subject.make(values);  // destroyed without ever having been active
  subject.unmake();
  return "created, activated, used, deactivated and destroyed 2 times; destroyed unused once";
}

std::string determinism(Subject& subject, const std::vector<double>& values) {
  std::vector<std::byte> first;
  constexpr int times = 4;
  for (int i = 0; i < times; ++i) {
    const Life life(subject, values);
    Trial trial = subject.use();
    if (i == 0) first = std::move(trial.outputs);
    if (i > 0 && trial.outputs != first) {
      throw Broken(fmt::format("use {} of {} gave other bits than the first", i + 1, times));
    }
  }
  return fmt::format("{} equal bytes in {} lives", first.size(), times);
}

std::string repeated_activation(Subject& subject, const std::vector<double>& values, bool compare) {
  constexpr int times = 4;
  subject.make(values);
  std::vector<std::byte> first;
  try {
    for (int i = 0; i < times; ++i) {
      subject.activate();
      Trial trial = subject.use();
      subject.deactivate();
      if (i == 0) first = std::move(trial.outputs);
      if (compare && i > 0 && trial.outputs != first) {
        throw Broken(fmt::format("activation {} gave other bits than the first", i + 1));
      }
    }
  } catch (...) {
    subject.deactivate();
    subject.unmake();
    throw;
  }
  subject.unmake();
  return fmt::format("{} activations of one object", times);
}

/// Values to try of a parameter: both ends, of a choice all of them.
std::vector<double> ends_of(const StageParameter& parameter) {
  if (parameter.type != ParameterType::choice) return {parameter.minimum, parameter.maximum};
  std::vector<double> all;
  for (double value = 0.0; value <= parameter.maximum; value += 1.0)
    all.push_back(value);
  return all;
}

std::string parameter_ends(Subject& subject, const StageInfo& stage, const std::vector<double>& values) {
  std::string usual;
  {
    const Life life(subject, values);
    usual = subject.use().violation;
  }
  int tried = 0;
  for (std::size_t i = 0; i < stage.parameters.size(); ++i) {
    for (const double end : ends_of(stage.parameters[i])) {
      std::vector<double> changed = values;
      changed[i] = end;
      const std::string where = fmt::format("{} = {}", stage.parameters[i].name, end);
      try {
        const Life life(subject, changed);
        const Trial trial = subject.use();
        if (usual.empty() && !trial.violation.empty()) throw Broken(trial.violation);
      } catch (const std::runtime_error& failed) {
        throw Broken(fmt::format("{}: {}", where, failed.what()));
      }
      ++tried;
    }
  }
  return fmt::format("{} settings of {} parameters", tried, stage.parameters.size());
}

/// Blocks that a life leaves behind, once everything is warm.
std::string leaks(Subject& subject, const std::vector<double>& values) {
  constexpr int warm = 3, times = 8;
  std::int64_t before = 0;
  for (int i = 0; i < warm + times; ++i) {
    if (i == warm) before = subject.kept_blocks();
    const Life life(subject, values);
    (void)subject.use();
  }
  const std::int64_t left = subject.kept_blocks() - before;
  if (left >= times) throw Broken(fmt::format("{} blocks left behind by {} lives", left, times));
  return fmt::format("0 blocks left behind per life, over {} lives", times);
}

std::string frame_allocations(Subject& subject, const std::vector<double>& values) {
  const Life life(subject, values);
  (void)subject.use();
  std::uint64_t allocations = 0;
  constexpr int times = 3;
  for (int i = 0; i < times; ++i)
    allocations += subject.use().allocations;
  if (allocations != 0) throw Broken(fmt::format("{} allocations in {} uses", allocations, times));
  return fmt::format("0 allocations in {} uses", times);
}

/// Throws input_error for stages of Brace's own that are nothing by themselves.
void require_checkable(const StageInfo& stage) {
  if (stage.id() == "rays/mab")
    throw input_error(
        "{}: stage rays/mab has lists of rays that only its own braces make; accepted: rays/full_rate, and "
        "rays "
        "stages whose snippets bind nothing",
        stage.origin.string());
  if (stage.id() == "skip/auto")
    throw input_error(
        "{}: skip/auto becomes another stage of a session; accepted: that stage, e.g. "
        "skip/distance_map",
        stage.origin.string());
}

std::unique_ptr<Subject> make_subject(const StageInfo& stage, const CheckOptions& options) {
  require_checkable(stage);
  const std::string& family = stage.family;
  if (family == "cast") return make_cast_subject(stage, options);
  if (family == "rays") return make_rays_subject(stage, options);
  if (family == "skip") return make_skip_subject(stage, options);
  if (family == "stereo" || family == "warp") return make_picture_subject(stage, options);
  if (family == "predict" || family == "control" || family == "cost") return make_host_subject(stage);
  throw input_error(
      "{}: stage {} cannot be checked; accepted: rays, cast, skip, stereo, warp, control, predict, cost",
      stage.origin.string(), stage.id());
}

}  // namespace

bool common_clauses(Suite& suite, Subject& subject, const StageInfo& stage,
                    const std::vector<double>& values) {
  if (!suite.clause("lifecycle", [&] { return lifecycle(subject, values); })) return false;
  const bool steady = suite.clause("determinism", [&] { return determinism(subject, values); });
  suite.clause("repeated activation", [&] { return repeated_activation(subject, values, steady); });
  suite.clause("parameters at their ends", [&] { return parameter_ends(subject, stage, values); });
  if (!subject.is_native()) return true;
  suite.clause("no leaks", [&] { return leaks(subject, values); });
  if (subject.runs_on_host()) {
    suite.clause("no allocation per frame", [&] { return frame_allocations(subject, values); });
  }
  return true;
}

std::vector<ClauseResult> check_stage(const StageInfo& stage, const CheckOptions& options) {
  Suite suite(options.on_clause);
  const std::size_t messages = options.device == nullptr ? 0 : options.device->validation_messages().size();
  std::vector<double> values;
  for (const StageParameter& parameter : stage.parameters)
    values.push_back(parameter.default_value);
  const std::unique_ptr<Subject> subject = make_subject(stage, options);
  if (common_clauses(suite, *subject, stage, values)) subject->own_clauses(suite, values);
  if (options.device != nullptr && options.device->validation_enabled()) {
    suite.clause("validation layers silent", [&] {
      const auto& all = options.device->validation_messages();
      if (all.size() > messages)
        throw Broken(fmt::format("{} messages: {}", all.size() - messages, all[messages]));
      return std::string("0 messages");
    });
  }
  return suite.take();
}

}  // namespace brace
