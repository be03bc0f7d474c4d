#pragma once

#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "runtime/gpu/device.hpp"

namespace brace::gpu {

/// One device for all tests of a suite, with validation layers where they are installed: a test fails when it
/// caused a message. Skips without a usable device unless BRACE_REQUIRE_GPU=1.
class GpuTest : public testing::Test {
 protected:
  static std::unique_ptr<Device> open(const DeviceOptions& wanted, std::string& reason) {
    DeviceOptions options = wanted;
    options.validation = true;
    try {
      return std::make_unique<Device>(options);
    } catch (const Error& error) {
      reason = error.what();
      if (reason.find("validation") == std::string::npos) return nullptr;
    }
    options.validation = false;
    return std::make_unique<Device>(options);
  }

  static void SetUpTestSuite() { device_ = open({}, reason_); }
  static void TearDownTestSuite() { device_.reset(); }

  void SetUp() override {
    if (device_) {
      messages_before_ = device_->validation_messages().size();
      return;
    }
    const char* required = std::getenv("BRACE_REQUIRE_GPU");
    if (required && std::string_view(required) == "1") FAIL() << reason_;
    GTEST_SKIP() << reason_;
  }

  void TearDown() override {
    if (!device_) return;
    const auto& messages = device_->validation_messages();
    for (std::size_t i = messages_before_; i < messages.size(); ++i)
      ADD_FAILURE() << messages[i];
  }

  static Device& device() { return *device_; }
  /// For tests that cause messages on purpose.
  void forget_messages() { messages_before_ = device_->validation_messages().size(); }

 private:
  static inline std::unique_ptr<Device> device_;
  static inline std::string reason_;
  std::size_t messages_before_ = 0;
};

}  // namespace brace::gpu
