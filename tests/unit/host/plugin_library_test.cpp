#include "runtime/host/plugin_library.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/host/stage_registry.hpp"
#include "temporary_folder.hpp"

namespace brace {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::filesystem::path examples = EXAMPLE_PLUGINS;
const std::filesystem::path broken = BROKEN_PLUGINS;

/// The message of the Error that `call` ends with; its exit code is checked.
template <typename Call>
std::string message_of(ExitCode expected, Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), expected) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

std::string load_error(const std::filesystem::path& file, ExitCode code = ExitCode::device_or_plugin_failed) {
  return message_of(code, [&] { (void)PluginLibrary::load(file); });
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(PluginLibrary, LoadsAnExampleWithItsStages) {
  const auto library = PluginLibrary::load(examples / "alpha_beta.so");
  EXPECT_EQ(library->name(), "alpha_beta");
  EXPECT_EQ(library->version(), "1.0.0");
  EXPECT_EQ(library->abi_version(), BRACE_ABI_VERSION);
  ASSERT_EQ(library->stages().size(), 1u);
  EXPECT_STREQ(library->stages()[0].name, "alpha_beta");
  EXPECT_EQ(library->stages()[0].kind, BRACE_KIND_PREDICT);
}

TEST(PluginLibrary, MissingEntrySymbolNamesFileAndSymbol) {
  EXPECT_THAT(load_error(broken / "broken_no_entry.so"),
              AllOf(HasSubstr("broken_no_entry.so"), HasSubstr("expected the symbol brace_library_entry"),
                    HasSubstr("found none")));
}

TEST(PluginLibrary, WrongVersionNamesExpectedAndFound) {
  EXPECT_THAT(
      load_error(broken / "broken_version.so"),
      AllOf(HasSubstr("broken_version.so"), HasSubstr("expected 1.0"), HasSubstr("found 7.0 to 7.2")));
}

TEST(PluginLibrary, VersionThatWasNotOfferedIsRefused) {
  EXPECT_THAT(load_error(broken / "broken_negotiation.so"),
              AllOf(HasSubstr("expected 1.0"), HasSubstr("found 9.9")));
}

TEST(PluginLibrary, FailingEntryIsReported) {
  EXPECT_THAT(load_error(broken / "broken_entry_fails.so"),
              AllOf(HasSubstr("brace_library_entry failed"), HasSubstr("found BRACE_ERROR")));
}

struct BrokenField {
  const char* library;
  const char* field;
  const char* found;
};

class PluginDescriptor : public ::testing::TestWithParam<BrokenField> {};

TEST_P(PluginDescriptor, BrokenFieldIsNamedWithExpectedAndFound) {
  const BrokenField& field = GetParam();
  const std::string message = load_error(broken / (std::string(field.library) + ".so"));
  EXPECT_THAT(message, AllOf(HasSubstr(field.library), HasSubstr(field.field), HasSubstr("expected"),
                             HasSubstr(std::string("found ") + field.found)));
}

INSTANTIATE_TEST_SUITE_P(Each, PluginDescriptor,
                         ::testing::Values(BrokenField{"broken_no_stages", "stages", "none"},
                                           BrokenField{"broken_size", "descriptor.struct_size", "8"},
                                           BrokenField{"broken_kind", "kind", "99"},
                                           BrokenField{"broken_schedule", "kind", "schedule"},
                                           BrokenField{"broken_name", "name", "null"},
                                           BrokenField{"broken_create", "create", "null"},
                                           BrokenField{"broken_activate_alone", "activate, deactivate",
                                                       "one of them"},
                                           BrokenField{"broken_table", "functions.update", "null"},
                                           BrokenField{"broken_table_size", "functions.struct_size", "4"},
                                           BrokenField{"broken_default", "default_value", "2 in 0 to 1"},
                                           BrokenField{"broken_choices", "choices", "none"},
                                           BrokenField{"broken_param_name", "params.name", "'Bad Name'"},
                                           BrokenField{"broken_param_twice", "params.name", "'gain' twice"}),
                         [](const auto& each) { return std::string(each.param.library); });

TEST(PluginLibrary, TheSameLibraryWithoutDefectLoads) {
  EXPECT_EQ(PluginLibrary::load(broken / "broken_nothing.so")->stages().size(), 1u);
}

TEST(PluginLibrary, FileThatIsNotThereIsAnInputError) {
  EXPECT_THAT(load_error("/nowhere/a.so", ExitCode::bad_input),
              HasSubstr("/nowhere/a.so: there is no such file"));
}

TEST(PluginLibrary, TextIsNotALibrary) {
  const TemporaryFolder folder;
  EXPECT_THAT(load_error(folder.write("a.so", "#!/bin/sh\n")),
              AllOf(HasSubstr("expected a shared library (ELF)"), HasSubstr("found a file that is none")));
  EXPECT_THAT(load_error(folder.write("b.so", "")), HasSubstr("found an empty file"));
}

TEST(PluginLibrary, WrongArchitectureIsReadFromTheHeader) {
  const TemporaryFolder folder;
  std::string bytes = bytes_of(broken / "broken_nothing.so");
  bytes[18] = static_cast<char>(0xf3);  // e_machine: RISC-V
  EXPECT_THAT(load_error(folder.write("riscv.so", bytes)), HasSubstr("found one for RISC-V"));
  bytes[4] = 1;  // EI_CLASS: 32 bit
  EXPECT_THAT(load_error(folder.write("small.so", bytes)), HasSubstr("found 32-bit code"));
}

TEST(PluginLibrary, ObjectFileIsNotALibrary) {
  const TemporaryFolder folder;
  std::string bytes = bytes_of(broken / "broken_nothing.so");
  bytes[16] = 1;  // e_type: ET_REL
  EXPECT_THAT(load_error(folder.write("a.so", bytes)),
              AllOf(HasSubstr("expected a shared library"), HasSubstr("found an object file")));
}

TEST(PluginLibrary, LibraryCutShortAnywhereIsRefusedWithoutACrash) {
  const TemporaryFolder folder;
  const std::string bytes = bytes_of(broken / "broken_nothing.so");
  int refused = 0;
  for (std::size_t keep = 0; keep < 4096; keep += 97) {
    EXPECT_THROW((void)PluginLibrary::load(folder.write("a.so", bytes.substr(0, keep))), Error) << keep;
    ++refused;
  }
  EXPECT_GT(refused, 40);
}

TEST(PluginLibrary, UnresolvedSymbolsAreReportedByTheLinkersWords) {
  const TemporaryFolder folder;
  std::string bytes = bytes_of(examples / "aimd_control.so");
  // The dynamic linker resolves every symbol at once: one that nobody has is an error at load, not at a call.
  const std::size_t at = bytes.find("libc.so.6");
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 9, "libx.so.6");
  EXPECT_THAT(load_error(folder.write("a.so", bytes)), HasSubstr("libx.so.6"));
}

TEST(PluginSearch, SplitsThePathAtColons) {
  EXPECT_TRUE(split_plugin_path("").empty());
  const std::vector<std::filesystem::path> two = {"/a", "b c"};
  EXPECT_EQ(split_plugin_path("/a::b c:"), two);
}

TEST(PluginSearch, FolderMayHoldLibrariesAndGlslStagesOfAnyDepth) {
  const TemporaryFolder folder;
  const std::string manifest = "[stage]\nkind='skip'\nname='NAME'\nversion='1'\nhelp='h'\n";
  const auto named = [&](const std::string& name) {
    return std::string(manifest).replace(manifest.find("NAME"), 4, name);
  };
  folder.write("flat/stage.toml", named("flat"));
  folder.write("skip/nested/stage.toml", named("nested"));
  std::filesystem::copy(examples / "aimd_control.so", folder.path() / "aimd_control.so");
  StageRegistry registry;
  add_plugins(registry, {.given = {folder.path()}, .ambient = {}, .installed = {}});
  EXPECT_EQ(registry.find("skip", "flat", "test").origin, folder.path() / "flat/stage.toml");
  EXPECT_EQ(registry.find("skip", "nested", "test").origin, folder.path() / "skip/nested/stage.toml");
  EXPECT_NE(registry.find("control", "aimd", "test").native, nullptr);
}

TEST(PluginSearch, FileReachedTwiceIsLoadedOnce) {
  StageRegistry registry;
  add_plugins(registry,
              {.given = {examples / "alpha_beta.so"}, .ambient = {examples}, .installed = examples});
  EXPECT_EQ(registry.names("predict").size(), 1u);
}

TEST(PluginSearch, InstalledFolderMayBeMissingAndGivenOnesMayNot) {
  StageRegistry registry;
  add_plugins(registry, {.given = {}, .ambient = {}, .installed = "/nowhere"});
  EXPECT_THAT(
      message_of(ExitCode::bad_input,
                 [&] { add_plugins(registry, {.given = {"/nowhere"}, .ambient = {}, .installed = {}}); }),
      HasSubstr("plug-in path '/nowhere'"));
}

TEST(PluginSearch, TakenNameNamesBothFiles) {
  const TemporaryFolder folder;
  std::filesystem::copy(examples / "aimd_control.so", folder.path() / "copy.so");
  StageRegistry registry;
  const std::string message = message_of(ExitCode::device_or_plugin_failed, [&] {
    add_plugins(registry,
                {.given = {examples / "aimd_control.so", folder.path()}, .ambient = {}, .installed = {}});
  });
  EXPECT_THAT(message, AllOf(HasSubstr("copy.so"), HasSubstr("control/aimd"), HasSubstr("aimd_control.so")));
}

TEST(PluginSearch, LibraryOutlivesItsRegistry) {
  StageInfo kept;
  {
    StageRegistry registry;
    add_plugins(registry, {.given = {examples / "alpha_beta.so"}, .ambient = {}, .installed = {}});
    kept = registry.find("predict", "alpha_beta", "test");
  }
  EXPECT_STREQ(kept.native->name, "alpha_beta");  // would be unmapped memory
}

}  // namespace
}  // namespace brace
