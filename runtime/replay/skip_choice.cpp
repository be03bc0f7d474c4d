#include "runtime/replay/skip_choice.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "base/error.hpp"
#include "runtime/skip/choose_skip.hpp"

namespace brace {

namespace {

constexpr std::size_t tables_counted_max = 3;  // each is a pass over the volume

/// Mean share of occupied blocks under the transfer functions of the run: first, middle and last.
double mean_occupancy(const SceneOnDevice& scene, const std::vector<TransferTable>& tables) {
  const std::size_t count = std::min(tables.size(), tables_counted_max);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = count == 1 ? 0 : i * (tables.size() - 1) / (count - 1);
    sum += occupied_blocks(*scene.skip_kernels, {scene.volume, scene.statistics}, tables[at]);
  }
  return sum / static_cast<double>(count);
}

}  // namespace

void choose_skip_stage(const Session& session, SceneOnDevice& scene, bool messages) {
  const PipelineStage& named = session.pipeline.at("skip");
  scene.skip_stage = named;
  if (named.stage.name != "auto") return;
  const std::vector<TransferTable> tables = scene.versions.typical_tables();
  const double memory_mb = named.value("memory_mb");
  const std::uint64_t memory_bytes = memory_mb > 0.0
                                         ? static_cast<std::uint64_t>(memory_mb * 1e6)
                                         : scene.skip_kernels->device().limits().memory_bytes / 10 * 9;
  const SkipChoice choice = choose_skip({scene.volume.info(), mean_occupancy(scene, tables), tables.front(),
                                         scene.versions.changes(), memory_bytes});
  const std::string name = to_string(choice.options.kind);
  const auto found = std::find_if(session.skip_candidates.begin(), session.skip_candidates.end(),
                                  [&](const PipelineStage& stage) { return stage.stage.name == name; });
  if (found == session.skip_candidates.end())
    throw input_error("skip/auto chose skip/{}, which is not installed", name);
  scene.skip_stage = *found;
  scene.skip_stage.set("partitions", choice.options.partitions);
  scene.skip_stage.set("range_minima", static_cast<int>(choice.options.range_minima));
  scene.skip_stage.set("placement", static_cast<int>(choice.options.placement));
  scene.skip_reason = choice.reason;
  if (messages) fmt::print(stderr, "skip/auto: {}\n", choice.reason);
}

}  // namespace brace
