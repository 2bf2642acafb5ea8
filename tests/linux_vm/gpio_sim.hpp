#pragma once
// A GPIO chip of the kernel's own making (gpio-sim), whose lines a test pulls and reads.

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactree::vm_test {

class GpioSim {
 public:
  GpioSim(const std::string& name, const std::vector<std::string>& lines)
      : folder_("/sys/kernel/config/gpio-sim/" + name), lines_(lines.size()) {
    const std::string bank = folder_ + "/bank0";
    std::filesystem::create_directories(bank);
    write(bank + "/num_lines", std::to_string(lines.size()));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string line = bank + "/line" + std::to_string(i);
      std::filesystem::create_directories(line);
      write(line + "/name", lines[i]);
    }
    write(folder_ + "/live", "1");
    chip_ = read(bank + "/chip_name");
    device_ = "/sys/devices/platform/" + read(folder_ + "/dev_name") + "/" + chip_;
  }
  ~GpioSim() {
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
  void pull(std::size_t line, bool up) { write(file(line, "pull"), up ? "pull-up" : "pull-down"); }
  [[nodiscard]] bool level(std::size_t line) const { return read(file(line, "value")) == "1"; }
  [[nodiscard]] const std::string& chip() const { return chip_; }

 private:
  [[nodiscard]] std::string file(std::size_t line, const char* what) const {
    return device_ + "/sim_gpio" + std::to_string(line) + "/" + what;
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

  std::string folder_;
  std::size_t lines_;
  std::string chip_;
  std::string device_;
};

}  // namespace tactree::vm_test
