// Loop and memory annotations: docs/BOUND.md.

#include "plant_link/semihosting.hpp"

#include <cstddef>

namespace tactree::firmware::semihosting {
namespace {

enum class Operation : std::uint32_t {
  kOpen = 0x01,
  kPrint = 0x04,
  kWrite = 0x05,
  kRead = 0x06,
  kExit = 0x20,
};

constexpr std::uint32_t kApplicationExit = 0x20026;

std::uint32_t address_of(const void* pointer) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer));
}

#if defined(__riscv)
// The compiler has already placed the arguments in a0 and a1, where the call expects them. The
// three instructions must not be compressed and must not cross a page boundary.
[[gnu::naked, gnu::noinline, gnu::aligned(16)]] std::uint32_t call(Operation /*a0*/,
                                                                   std::uint32_t /*a1*/) {
  __asm volatile(
      ".option push\n\t"
      ".option norvc\n\t"
      "slli x0, x0, 0x1f\n\t"
      "ebreak\n\t"
      "srai x0, x0, 7\n\t"
      "ret\n\t"
      ".option pop");
}
#else
std::uint32_t call(Operation operation, std::uint32_t argument) {
  register std::uint32_t r0 __asm("r0") = static_cast<std::uint32_t>(operation);
  register std::uint32_t r1 __asm("r1") = argument;
  __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}
#endif

std::uint32_t call(Operation operation, const std::uint32_t (&arguments)[3]) {
  return call(operation, address_of(arguments));
}

}  // namespace

int open(std::span<const char> zero_terminated_name, Access access) {
  const auto length = static_cast<std::uint32_t>(zero_terminated_name.size() - 1U);
  return static_cast<int>(call(Operation::kOpen, {address_of(zero_terminated_name.data()),
                                                  static_cast<std::uint32_t>(access), length}));
}

// SYS_READ and SYS_WRITE return the number of bytes that were not transferred.
bool read(int file, std::span<std::byte> bytes) {
  while (!bytes.empty()) {  // bound: 1 (pipes do not divide messages as short as ours)
    const auto wanted = static_cast<std::uint32_t>(bytes.size());
    const std::uint32_t left = call(
        Operation::kRead, {static_cast<std::uint32_t>(file), address_of(bytes.data()), wanted});
    if (left >= wanted) {
      return false;
    }
    bytes = bytes.last(left);
  }
  return true;
}

bool write(int file, std::span<const std::byte> bytes) {
  return call(Operation::kWrite, {static_cast<std::uint32_t>(file), address_of(bytes.data()),
                                  static_cast<std::uint32_t>(bytes.size())}) == 0U;
}

void print(const char* text) { (void)call(Operation::kPrint, address_of(text)); }

void exit(std::uint32_t code) {
  const std::uint32_t arguments[3] = {kApplicationExit, code, 0};
  while (true) {  // bound: for_ever
    (void)call(Operation::kExit, arguments);
  }
}

}  // namespace tactree::firmware::semihosting
