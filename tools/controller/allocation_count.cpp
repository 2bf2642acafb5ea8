// Counts all heap allocations. These functions replace those of the C library and call its internal
// ones; operator new calls malloc().

#include <cstddef>
#include <cstdint>

#include "real_time.hpp"

#if defined(__SANITIZE_ADDRESS__)
#define TACTREE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TACTREE_SANITIZED 1
#endif
#endif

namespace {
thread_local std::uint64_t allocations = 0;
}  // namespace

namespace tactree::controller {
std::uint64_t allocations_of_this_thread() { return allocations; }
}  // namespace tactree::controller

#if defined(__GLIBC__) && !defined(TACTREE_SANITIZED)
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): names of the C library
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
#endif
