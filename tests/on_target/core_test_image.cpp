// core_test on a board.

#include "check.hpp"
#include "golden_blobs.hpp"
#include "plant_link/semihosting.hpp"
#include "platform.hpp"

extern "C" std::byte image_ram_end[];

void tactree_tick() {}

namespace tactree::test {

void print(const char* text) { firmware::semihosting::print(text); }

// The last bytes of the RAM.
std::span<std::byte> exact_buffer(std::size_t size) {
  return {image_ram_end - (size + 3) / 4 * 4, size};
}

}  // namespace tactree::test

int main() {
  using namespace tactree;
  const hal::CapturedFault fault = firmware::take_captured_fault();
  if (fault.present()) {
    test::print("the test faulted, at pc (decimal) ");
    test::print_number(fault.pc);
    test::print("\n");
    firmware::semihosting::exit(1);
  }
  firmware::semihosting::exit(static_cast<std::uint32_t>(test::run_core_tests()));
}
