// core_test on the host, the source of the known answers.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>

#include "check.hpp"
#include "golden_blobs.hpp"

namespace tactree::test {

void print(const char* text) { std::fputs(text, stdout); }

// The end of the last readable page.
std::span<std::byte> exact_buffer(std::size_t size) {
  static std::byte* const end = [] {
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const std::size_t room = (kExactBytesMax + page - 1) / page * page;
    void* memory = ::mmap(nullptr, room + page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ::mprotect(memory, room, PROT_READ | PROT_WRITE);
    return static_cast<std::byte*>(memory) + room;
  }();
  return {end - (size + 3) / 4 * 4, size};
}

}  // namespace tactree::test

int main() { return tactree::test::run_core_tests(); }
