// A machine without a Vulkan driver, folders that cannot be written, a full disk, a user who gives up.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include "tests/cli/command.hpp"

namespace brace {
namespace {

using test::Outcome;
using test::quick_session;
using test::RunOptions;
using test::Workplace;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const RunOptions no_vulkan = {{{"VK_ICD_FILENAMES", "/dev/null"}, {"VK_DRIVER_FILES", "/dev/null"}}};

TEST(CliNoVulkan, DoctorSaysWhatToInstallAndWhatCannotBeKept) {
  RunOptions options = no_vulkan;
  options.environment["XDG_CACHE_HOME"] = "/proc/nowhere";
  const Outcome outcome = Workplace().brace({"doctor"}, options);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("/proc/nowhere/brace/spirv cannot be written"));
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("FAIL"), HasSubstr("apt-get install"), HasSubstr("mesa-vulkan-drivers")));
}

TEST(CliNoVulkan, ARunSaysItTooAndLeavesNothing) {
  Workplace place;
  place.write("s.toml", quick_session());
  const Outcome outcome = place.brace({"run", "s.toml", "--out", "runs/a"}, no_vulkan);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("mesa-vulkan-drivers"));
  EXPECT_THAT(place.names(), ElementsAre("s.toml"));
}

TEST(CliNoVulkan, AnUnknownGpuListsThoseThatThereAre) {
  Workplace place;
  place.write("s.toml", quick_session());
  const Outcome outcome = place.brace({"run", "s.toml", "--gpu", "no such device", "--out", "a"});
  EXPECT_THAT(outcome.exit_code, testing::AnyOf(2, 3));
  EXPECT_THAT(outcome.err, HasSubstr("no such device"));
  EXPECT_THAT(place.names(), ElementsAre("s.toml"));
  EXPECT_EQ(place.brace({"doctor", "--gpu", "no such device"}).exit_code, outcome.exit_code);
}

TEST(CliDevice, DoctorFindsADeviceHere) {
  const Outcome outcome = Workplace().brace({"doctor", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("\"ok\": true"));
  EXPECT_THAT(outcome.out,
              testing::ContainsRegex("pipeline.cast = ..(dvr|native).. on this .*; dvr [0-9.]+ ms"));
}

TEST(CliData, AMissingDataFolderIsNamed) {
  const Outcome outcome = Workplace().brace({"list", "stages"}, {{{"BRACE_DATA_DIR", "/nowhere"}}});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("BRACE_DATA_DIR=/nowhere"));
}

TEST(CliOut, AFolderThatIsNotOursIsRefusedAndKept) {
  Workplace place;
  place.write("s.toml", quick_session());
  place.write("mine/letter.txt", "dear");
  const Outcome outcome = place.brace({"run", "s.toml", "--out", "mine"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("mine"), HasSubstr("--out")));
  EXPECT_EQ(place.read("mine/letter.txt"), "dear");
  EXPECT_THAT(place.names(), ElementsAre("mine", "s.toml"));
}

TEST(CliOut, AnEarlierRunWithAStrangersFileIsRefusedAndKept) {
  Workplace place;
  place.write("s.toml", quick_session());
  ASSERT_EQ(place.brace({"run", "s.toml", "--out", "a"}).exit_code, 0);
  place.write("a/notes.txt", "dear");
  const Outcome outcome = place.brace({"run", "s.toml", "--out", "a"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("notes.txt"));
  EXPECT_EQ(place.read("a/notes.txt"), "dear");
}

TEST(CliOut, PlacesThatCannotBeWrittenAreRefused) {
  Workplace place;
  place.write("s.toml", quick_session());
  for (const char* out : {"/proc/brace", "/dev/full", "s.toml", "s.toml/below", "/dev/null/below"}) {
    const Outcome outcome = place.brace({"run", "s.toml", "--out", out});
    EXPECT_EQ(outcome.exit_code, 2) << out;
    EXPECT_THAT(outcome.err, HasSubstr("--out")) << out;
  }
  EXPECT_THAT(place.names(), ElementsAre("s.toml"));
}

TEST(CliOut, AFailedRunLeavesTheEarlierOneAsItWas) {
  Workplace place;
  place.write("s.toml", quick_session());
  ASSERT_EQ(place.brace({"run", "s.toml", "--out", "a"}).exit_code, 0);
  const std::string before = place.read("a/frames.csv");
  ASSERT_EQ(place.brace({"run", "s.toml", "--out", "a"}, no_vulkan).exit_code, 3);
  ASSERT_EQ(place.brace({"run", "s.toml", "--out", "a", "--set", "scene.volume=nothing.nrrd"}).exit_code, 2);
  EXPECT_EQ(place.read("a/frames.csv"), before);
  EXPECT_THAT(place.names(), ElementsAre("a", "s.toml"));
}

TEST(CliFullDisk, SaysSoAndLeavesNothing) {
  Workplace place;
  place.write("s.toml", quick_session());
  const std::filesystem::path disk = place / "disk";
  std::filesystem::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=16k") != 0) {
    GTEST_SKIP() << "a small disk cannot be mounted here (not root, or a container without that right)";
  }
  const Outcome outcome = place.brace({"run", "s.toml", "--out", "disk/a", "--set", "output.images=every:1"});
  const bool left = !std::filesystem::is_empty(disk);
  ::umount(disk.c_str());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("No space left"), HasSubstr("--out")));
  EXPECT_FALSE(left);
}

TEST(CliInterrupt, ARunThatIsInterruptedEndsByTheSignalAndLeavesNothing) {
  Workplace place;
  place.write("s.toml", quick_session());
  for (const int signal : {SIGINT, SIGTERM}) {
    const Outcome outcome = place.brace({"run", "s.toml", "--out", "a", "--frames", "2000000", "--set",
                                         "trace.loop=true", "--set", "output.error=every:1"},
                                        {.environment = {}, .interrupt_with = signal});
    EXPECT_EQ(outcome.signal, signal) << outcome.exit_code << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("interrupted; no run directory was written"));
    EXPECT_THAT(place.names(), ElementsAre("s.toml"));
  }
}

TEST(CliInterrupt, APacingRunIsInterruptedToo) {
  Workplace place;
  place.write("s.toml", quick_session() + "[[clock.script]]\nfrom_s = 0\ncast_ms = 14\nwarp_ms = 1\n");
  const Outcome outcome = place.brace({"run", "s.toml", "--out", "b/a/../../a", "--frames", "10000000",
                                       "--set", "trace.loop=true", "--set", "clock.cost=scripted"},
                                      {.environment = {}, .interrupt_with = SIGINT});
  EXPECT_EQ(outcome.signal, SIGINT) << outcome.exit_code << outcome.err;
  EXPECT_THAT(place.names(), ElementsAre("s.toml"));
}

}  // namespace
}  // namespace brace
