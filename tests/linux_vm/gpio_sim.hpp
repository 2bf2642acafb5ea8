#pragma once
// A GPIO chip of the kernel's own making (gpio-sim), whose lines a test pulls and reads.

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tactree/hal/linux/file_descriptor.hpp"

namespace tactree::vm_test {

class GpioSim {
 public:
  GpioSim(const std::string& name, const std::vector<std::string>& lines)
      : label_("sim-" + name),
        folder_("/sys/kernel/config/gpio-sim/" + name),
        lines_(lines.size()) {
    const std::string bank = folder_ + "/bank0";
    std::filesystem::create_directories(bank);
    write(bank + "/num_lines", std::to_string(lines.size()));
    write(bank + "/label", label_);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string line = bank + "/line" + std::to_string(i);
      std::filesystem::create_directories(line);
      write(line + "/name", lines[i]);
    }
    write(folder_ + "/live", "1");
    chip_ = read(bank + "/chip_name");
    device_ = "/sys/devices/platform/" + read(folder_ + "/dev_name") + "/" + chip_;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      pulls_.push_back(opened(file(i, "pull"), O_WRONLY));
      values_.push_back(opened(file(i, "value"), O_RDONLY));
    }
  }
  ~GpioSim() {
    pulls_.clear();
    values_.clear();
    std::error_code ignored;
    std::ofstream(folder_ + "/live") << "0";
    for (std::size_t i = 0; i < lines_; ++i) {
      std::filesystem::remove(folder_ + "/bank0/line" + std::to_string(i), ignored);
    }
    std::filesystem::remove(folder_ + "/bank0", ignored);
    std::filesystem::remove(folder_, ignored);
  }
  GpioSim(const GpioSim&) = delete;
  GpioSim& operator=(const GpioSim&) = delete;

  /// As the wire from outside does.
  void pull(std::size_t line, bool up) {
    const std::string text = up ? "pull-up" : "pull-down";
    if (::pwrite(pulls_[line].get(), text.data(), text.size(), 0) < 0) {
      throw std::runtime_error(file(line, "pull") + ": cannot be written");
    }
  }
  [[nodiscard]] bool level(std::size_t line) const {
    char value = '0';
    return ::pread(values_[line].get(), &value, 1, 0) == 1 && value == '1';
  }
  [[nodiscard]] const std::string& chip() const { return chip_; }
  /// The name it goes by in gpiodetect.
  [[nodiscard]] const std::string& label() const { return label_; }

 private:
  [[nodiscard]] std::string file(std::size_t line, const char* what) const {
    return device_ + "/sim_gpio" + std::to_string(line) + "/" + what;
  }
  static hal::FileDescriptor opened(const std::string& file, int how) {
    hal::FileDescriptor descriptor(::open(file.c_str(), how | O_CLOEXEC));
    if (descriptor.get() < 0) {
      throw std::runtime_error(file + ": cannot be opened");
    }
    return descriptor;
  }
  static void write(const std::string& file, const std::string& text) {
    std::ofstream out(file);
    out << text << std::flush;
    if (!out) {
      throw std::runtime_error(file + ": cannot be written");
    }
  }
  static std::string read(const std::string& file) {
    std::string text;
    std::getline(std::ifstream(file) >> std::ws, text);
    return text;
  }

  std::string label_;
  std::string folder_;
  std::size_t lines_;
  std::string chip_;
  std::string device_;
  std::vector<hal::FileDescriptor> pulls_;
  std::vector<hal::FileDescriptor> values_;
};

}  // namespace tactree::vm_test
