#include "runtime/session/picture_settings.hpp"

#include <set>
#include <sstream>

#include "base/toml_file.hpp"

namespace brace {

namespace {

void keep_only(toml::table* table, const std::set<std::string>& names) {
  if (table == nullptr) return;
  for (auto entry = table->begin(); entry != table->end();)
    entry = names.contains(std::string(entry->first.str())) ? std::next(entry) : table->erase(entry);
}

}  // namespace

std::string picture_settings(const Session& session) {
  toml::table settings = parse_toml(session.resolved_toml, session.name);
  for (const char* name : {"trace", "gaze", "clock", "run", "compare", "plan"})
    settings.erase(name);
  const StageInfo &cast = session.pipeline.at("cast").stage, &skip = session.pipeline.at("skip").stage;
  keep_only(settings["pipeline"].as_table(), {"cast", "skip"});
  keep_only(settings["stage"].as_table(), {cast.name, cast.id(), skip.name, skip.id(), "full_rate"});
  keep_only(settings["output"].as_table(), {"ideal", "ideal_pose", "ideal_cast"});
  std::ostringstream text;
  text << settings;
  return text.str();
}

}  // namespace brace
