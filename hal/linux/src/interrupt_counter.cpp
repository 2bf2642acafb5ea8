// Loop and memory annotations: docs/BOUND.md.

#include "interrupt_counter.hpp"

#include <fcntl.h>

#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>

#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {
namespace {

namespace fs = std::filesystem;

const std::string kFolder = "/sys/kernel/irq";
constexpr std::size_t kConsumerBytes = 31;  // the kernel truncates consumer names to this length
constexpr std::size_t kText = 4096;         // one page, the maximum that the kernel writes

bool is_used_by(const fs::path& interrupt, const std::string& consumer) {
  std::ifstream file(interrupt / "actions");
  std::string user;
  while (std::getline(file, user, ',')) {  // bound: users of an interrupt
    if (user == consumer || user == consumer + "\n") {
      return true;
    }
  }
  return false;
}

}  // namespace

std::set<std::string> interrupts_of(const std::string& consumer) {
  std::set<std::string> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(kFolder, error)) {  // bound: interrupts
    if (is_used_by(entry.path(), consumer.substr(0, kConsumerBytes))) {
      found.insert(entry.path().filename().string());
    }
  }
  return found;
}

InterruptCounter::InterruptCounter(const std::string& interrupt)
    : file_(::open((kFolder + "/" + interrupt + "/per_cpu_count").c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_.get() < 0) {
    throw GpioError(kFolder + "/" + interrupt +
                    "/per_cpu_count: cannot be opened (hint: mount sysfs)");
  }
}

// The file has one number per processor, separated by commas.
std::uint32_t InterruptCounter::read() const noexcept {
  std::array<char, kText> text;
  const ssize_t size = ::pread(file_.get(), text.data(), text.size(), 0);
  std::uint32_t sum = 0;
  const char* at = text.data();
  const char* const end = at + (size > 0 ? size : 0);
  while (at < end) {  // bound: kText
    std::uint32_t value = 0;
    at = std::from_chars(at, end, value).ptr + 1;
    sum += value;
  }
  return sum;
}

}  // namespace tactree::hal::linux_gpio
