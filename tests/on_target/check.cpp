#include "check.hpp"

namespace tactree::test {
namespace {

constexpr std::uint32_t kMaxTold = 20;
std::uint32_t checks = 0;
std::uint32_t failures = 0;

}  // namespace

void print_number(std::uint32_t number) {
  char digits[11] = {};
  char* first = digits + 10;
  do {
    *--first = static_cast<char>('0' + number % 10U);
    number /= 10U;
  } while (number > 0);
  print(first);
}

void print_hexadecimal(std::uint32_t number) {
  char digits[11] = "0x";
  for (std::uint32_t i = 0; i < 8; ++i) {
    digits[2 + i] = "0123456789ABCDEF"[(number >> (28U - 4U * i)) & 0xFU];
  }
  print(digits);
}

void check(bool good, const char* sentence, const char* file, std::uint32_t line) {
  ++checks;
  if (good) {
    return;
  }
  ++failures;
  if (failures > kMaxTold) {
    return;
  }
  print(file);
  print(":");
  print_number(line);
  print(": not so: ");
  print(sentence);
  print("\n");
}

void check_answer(std::uint32_t found, std::uint32_t known, const char* file, std::uint32_t line) {
  check(found == known, "the known answer", file, line);
  if (found != known) {
    print("  found ");
    print_hexadecimal(found);
    print(", known ");
    print_hexadecimal(known);
    print("\n");
  }
}

int run_core_tests() {
  test_arithmetic();
  test_memory();
  test_golden_blobs();
  test_corrupt_blobs();
  print_number(checks);
  print(" checks, ");
  print_number(failures);
  print(" failures\n");
  return failures == 0 && checks > 0 ? 0 : 1;
}

}  // namespace tactree::test
