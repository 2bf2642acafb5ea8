#pragma once
// Small images for the analysis, compiled by the test that needs them.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/wcet/bound.hpp"
#include "tactree/wcet/bound_error.hpp"

namespace tactree::test {

/// Skipped if the cross compiler is missing.
class SampleImage : public FolderTest {
 protected:
  void SetUp() override {
    if (std::system("arm-none-eabi-g++ --version >/dev/null 2>&1") != 0) {
      GTEST_SKIP() << "no arm-none-eabi-g++";
    }
  }

  /// The bound of tick() in a program; with `timing` also in cycles.
  wcet::Bound bound_of(const std::string& code, const wcet::Parameters& parameters = {},
                       const wcet::BoardTiming* timing = nullptr) {
    write("sample.cpp", code);
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
    return bound_of_image(folder_ / "sample.elf", parameters, timing);
  }

  wcet::Bound bound_of_image(const std::filesystem::path& image,
                             const wcet::Parameters& parameters = {},
                             const wcet::BoardTiming* timing = nullptr) {
    wcet::BoundOptions options;
    options.timing = timing;
    options.image = image;
    options.sources = {folder_};
    options.entries = {{"tick", 1}};
    options.parameters = parameters;
    return wcet::worst_case(options);
  }

  /// Message of the refusal; "": not refused.
  std::string refusal(const std::string& code) {
    return message_of<wcet::BoundError>([&] { (void)bound_of(code); });
  }
};

}  // namespace tactree::test
