#include "runtime/gpu/device.hpp"

#include <cstdlib>

#include <gmock/gmock.h>

#include "gpu/gpu_fixture.hpp"
#include "runtime/gpu/commands.hpp"
#include "runtime/gpu/device_context.hpp"

namespace brace::gpu {
namespace {

using testing::HasSubstr;
using DeviceRoom = GpuTest;

DeviceInfo made_up(std::uint32_t index, const char* name, DeviceType type, const char* uuid) {
  DeviceInfo info;
  info.index = index;
  info.name = name;
  info.type = type;
  info.uuid = uuid;
  return info;
}

std::vector<DeviceInfo> three_devices() {
  return {made_up(0, "llvmpipe (LLVM 15)", DeviceType::software, "00aa"),
          made_up(1, "Intel Graphics", DeviceType::integrated, "00bb"),
          made_up(2, "NVIDIA H200", DeviceType::discrete, "ab-cd")};
}

std::string message_of(const std::vector<DeviceInfo>& devices, const std::string& select, ExitCode expected) {
  try {
    choose_device(devices, select);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), expected);
    return error.what();
  }
  return "";
}

TEST(DeviceChoice, PrefersDiscreteThenIntegratedThenSoftware) {
  auto devices = three_devices();
  EXPECT_EQ(choose_device(devices, ""), 2u);
  devices[2].missing = "synchronization2";
  EXPECT_EQ(choose_device(devices, ""), 1u);
  devices.pop_back();
  devices.pop_back();
  EXPECT_EQ(choose_device(devices, ""), 0u);
}

TEST(DeviceChoice, AcceptsIndexNamePartAndUuid) {
  const auto devices = three_devices();
  EXPECT_EQ(choose_device(devices, "1"), 1u);
  EXPECT_EQ(choose_device(devices, "LLVMpipe"), 0u);
  EXPECT_EQ(choose_device(devices, "00-BB"), 1u);
}

TEST(DeviceChoice, NamesWhatIsThereWhenTheSelectionIsWrong) {
  auto devices = three_devices();
  EXPECT_THAT(message_of(devices, "radeon", ExitCode::bad_input), HasSubstr("NVIDIA H200"));
  EXPECT_THAT(message_of(devices, "n", ExitCode::bad_input), HasSubstr("several"));
  EXPECT_THAT(message_of(devices, "7", ExitCode::bad_input), HasSubstr("no Vulkan device"));
  devices[2].missing = "scalarBlockLayout";
  EXPECT_THAT(message_of(devices, "h200", ExitCode::device_or_plugin_failed), HasSubstr("scalarBlockLayout"));
  devices.erase(devices.begin(), devices.begin() + 2);
  EXPECT_THAT(message_of(devices, "", ExitCode::device_or_plugin_failed), HasSubstr("scalarBlockLayout"));
}

TEST_F(DeviceRoom, ReportsTheLimitsThatKernelsRelyOn) {
  const DeviceLimits& limits = device().limits();
  EXPECT_GE(limits.storage_buffer_bytes_max, 128u << 20);
  EXPECT_GE(limits.push_constant_bytes_max, 128u);
  EXPECT_GE(limits.allocation_bytes_max, 1u << 30);
  EXPECT_GE(limits.texel_buffer_texels_max, 65536u);
  EXPECT_GE(limits.work_group_invocations_max, 128u);
  EXPECT_GT(limits.subgroup_size, 0u);
  EXPECT_GT(limits.timestamp_period_ns, 0.0);
  EXPECT_GT(limits.memory_bytes, 0u);
  EXPECT_EQ(device().info().uuid.size(), 32u);
  EXPECT_EQ(limits.is_software, device().info().type == DeviceType::software);
  EXPECT_FALSE(list_devices().empty());
}

TEST_F(DeviceRoom, TwoDevicesLiveSideBySide) {
  std::string reason;
  const auto second =
      open({.select = device().info().uuid, .validation = true, .force_staging = false}, reason);
  const Buffer here(device(), "here", 64, Memory::readback);
  const Buffer there(*second, "there", 64, Memory::readback);
  CommandList first_list(device(), "first"), second_list(*second, "second");
  first_list.fill(here, 1);
  second_list.fill(there, 2);
  submit_and_wait(second_list);
  submit_and_wait(first_list);
  EXPECT_EQ(here.mapped_as<std::uint32_t>()[0], 1u);
  EXPECT_EQ(there.mapped_as<std::uint32_t>()[0], 2u);
}

TEST_F(DeviceRoom, ValidationMessagesAreKept) {
  std::string reason;
  const auto other = open({}, reason);
  if (!other->validation_enabled()) GTEST_SKIP() << "the validation layers are not installed";
  const DeviceContext& context = other->context();
  VkBufferCreateInfo info{};  // a wrong sType and no size
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  VkBuffer buffer = nullptr;
  context.vk.vkCreateBuffer(context.device, &info, nullptr, &buffer);
  context.vk.vkDestroyBuffer(context.device, buffer, nullptr);
  EXPECT_FALSE(other->validation_messages().empty());
}

TEST_F(DeviceRoom, ALostDeviceIsADeviceErrorThatSaysSo) {
  try {
    check_vk(VK_ERROR_DEVICE_LOST, device().context(), "wait for cast");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::device_or_plugin_failed);
    EXPECT_THAT(error.what(), HasSubstr("device lost"));
    EXPECT_THAT(error.what(), HasSubstr("wait for cast"));
  }
}

TEST(NoDriverDeathTest, SaysWhichPackagesToInstall) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  // In a process of its own: the loader reads its environment once.
  const auto open_without_driver = [] {
    setenv("VK_ICD_FILENAMES", "/nonexistent.json", 1);
    setenv("VK_DRIVER_FILES", "/nonexistent.json", 1);
    try {
      const Device device;
      std::_Exit(0);
    } catch (const Error& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(static_cast<int>(error.exit_code()));
    }
  };
  EXPECT_EXIT(open_without_driver(), testing::ExitedWithCode(3), "mesa-vulkan-drivers");
}

}  // namespace
}  // namespace brace::gpu
