#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/suggest.hpp"
#include "tools/command.hpp"

namespace brace {

namespace {

namespace fs = std::filesystem;

/// A file of the new project: its name there and its template below share/brace/templates.
struct ProjectFile {
  std::string name, from;
};

struct Form {
  const char* name;  // folder of its templates
  const char* option;
  std::vector<std::string> kinds;
  const char* why_no_other;
};

/// What `brace run` takes in each form.
const std::vector<Form>& forms() {
  static const std::vector<Form> all = {
      {"glsl", "--glsl", {"cast", "rays", "skip", "warp"}, "that kind is not code on the GPU"},
      {"native", "--native", {"cast", "predict", "control"}, "a run takes that kind as GLSL or built in"}};
  return all;
}

bool has_kind(const Form& form, const std::string& kind) {
  return std::find(form.kinds.begin(), form.kinds.end(), kind) != form.kinds.end();
}

std::string accepted_kinds() {
  std::string text;
  for (const Form& form : forms())
    text += fmt::format("{}{} {}", text.empty() ? "" : "; ", form.option, join(form.kinds));
  return text;
}

/// Without an option: the first form that the kind has.
const Form& choose_form(const NewStageCommand& command) {
  const auto& families = stage_families();
  if (std::find(families.begin(), families.end(), command.kind) == families.end()) {
    throw input_error("new-stage: there is no kind '{}'{}; accepted: {}", command.kind,
                      did_you_mean(command.kind, families), accepted_kinds());
  }
  if (command.glsl && command.native) throw input_error("new-stage: accepted: --glsl or --native, not both");
  for (const Form& form : forms()) {
    const bool asked = form.option == std::string(command.native ? "--native" : "--glsl");
    if ((command.glsl || command.native) && !asked) continue;
    if (has_kind(form, command.kind)) return form;
    if (!asked || !(command.glsl || command.native)) continue;
    throw input_error("new-stage: a {} stage cannot be made with {}: {}; accepted: {}", command.kind,
                      form.option, form.why_no_other, accepted_kinds());
  }
  throw input_error(
      "new-stage: there is no template for a {} stage: runs take the built-in ones; accepted: {}",
      command.kind, accepted_kinds());
}

void check_name(const NewStageCommand& command) {
  const std::string& name = command.name;
  const bool is_word = !name.empty() && name[0] >= 'a' && name[0] <= 'z' && name.size() <= 64 &&
                       name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
  if (!is_word) {
    throw input_error("new-stage: name '{}': accepted: snake_case (a-z, 0-9, _), at most 64 letters", name);
  }
  const std::vector<std::string> taken = make_stages({}).registry.names(command.kind);
  if (std::find(taken.begin(), taken.end(), name) == taken.end()) return;
  throw input_error("new-stage: there is a stage {}/{} already; accepted: a name of its own (taken: {})",
                    command.kind, name, join(taken));
}

std::vector<ProjectFile> project_files(const Form& form, const std::string& kind, const std::string& name) {
  const std::string folder = form.name;
  const std::string own = folder + "/" + kind;
  std::vector<ProjectFile> files = {{"README.md", folder + "/README.md"}, {"session.toml", "session.toml"}};
  if (folder == "glsl") {
    files.push_back({"stage.toml", own + "/stage.toml"});
    files.push_back({name + ".glsl", own + "/stage.glsl"});
  } else {
    files.push_back({"CMakeLists.txt", folder + "/CMakeLists.txt"});
    files.push_back({name + ".c", own + "/stage.c"});
  }
  return files;
}

std::string read_template(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in) throw device_error("{}: the template cannot be read; install Brace again", file.string());
  return text.str();
}

std::string filled_in(std::string text, const std::map<std::string, std::string>& values) {
  for (const auto& [key, value] : values) {
    for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + value.size()))
      text.replace(at, key.size(), value);
  }
  return text;
}

/// Everything or nothing: a file in the way is found before the first one is written.
void write_files(const fs::path& folder, const std::map<std::string, std::string>& texts) {
  for (const auto& [name, text] : texts) {
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(folder / name, ignored))) continue;
    throw input_error("{}: is there already and is left alone; accepted: a folder without it (--out DIR)",
                      (folder / name).string());
  }
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw input_error("{}: cannot be made: {}", folder.string(), failed.message());
  for (const auto& [name, text] : texts) {
    std::ofstream out(folder / name, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw input_error("{}: cannot be written", (folder / name).string());
  }
}

}  // namespace

int new_stage_command(const NewStageCommand& command) {
  const Form& form = choose_form(command);
  check_name(command);
  const bool is_native = form.name == std::string("native");
  const std::string plugin_path = is_native ? "build" : ".";
  const fs::path data = data_folder();
  const std::map<std::string, std::string> values = {
      {"@NAME@", command.name},
      {"@KIND@", command.kind},
      {"@PREFIX@", fs::weakly_canonical(data / ".." / "..").string()},
      {"@RUN@", "brace run session.toml --plugin-path " + plugin_path}};
  std::map<std::string, std::string> texts;
  for (const ProjectFile& file : project_files(form, command.kind, command.name))
    texts[file.name] = filled_in(read_template(data / "templates" / file.from), values);
  const fs::path folder = command.out.empty() ? fs::path(command.name) : fs::path(command.out);
  write_files(folder, texts);

  fmt::print("{}: stage {}/{}\n", folder.string(), command.kind, command.name);
  for (const auto& [name, text] : texts)
    fmt::print("  {}\n", name);
  fmt::print("Next:\n  cd {}\n", folder.string());
  if (is_native) {
    fmt::print("  cmake -B build -DCMAKE_PREFIX_PATH={}\n  cmake --build build\n", values.at("@PREFIX@"));
  }
  fmt::print("  {}\n", values.at("@RUN@"));
  return static_cast<int>(ExitCode::done);
}

}  // namespace brace
