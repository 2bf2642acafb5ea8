#pragma once
// Small images for the analysis, compiled where they are needed.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tactree/bound/bound.hpp"
#include "tactree/bound/bound_error.hpp"

namespace tactree::test {

/// Skipped where the compiler for the boards is missing.
class SampleImage : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("arm-none-eabi-g++ --version >/dev/null 2>&1") != 0) {
      GTEST_SKIP() << "no arm-none-eabi-g++";
    }
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// The bound of tick() in a program.
  bound::Bound bound_of(const std::string& code, const bound::Parameters& parameters = {}) {
    std::ofstream(folder_ / "sample.cpp") << code;
    const std::string command =
        "cd '" + folder_.string() +
        "' && arm-none-eabi-g++ -std=c++20 -mthumb -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 "
        "-mfloat-abi=hard -O2 -g -fno-exceptions -fno-rtti -ffreestanding -nostdlib "
        "-nostartfiles -Wl,-e,tick -o sample.elf sample.cpp 2>log";
    if (std::system(command.c_str()) != 0) {
      std::ifstream log(folder_ / "log");
      ADD_FAILURE() << std::string(std::istreambuf_iterator<char>(log), {});
      return {};
    }
    return bound_of_image(folder_ / "sample.elf", parameters);
  }

  bound::Bound bound_of_image(const std::filesystem::path& image,
                              const bound::Parameters& parameters = {}) {
    bound::BoundOptions options;
    options.image = image;
    options.sources = folder_;
    options.entries = {{"tick", 1}};
    options.parameters = parameters;
    return bound::worst_case(options);
  }

  /// What the analysis says when it refuses; "" when it does not.
  std::string refusal(const std::string& code) {
    try {
      (void)bound_of(code);
      return "";
    } catch (const bound::BoundError& error) {
      return error.what();
    }
  }

  std::filesystem::path folder_;
};

}  // namespace tactree::test
