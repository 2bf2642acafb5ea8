// tactree-import-mesh FILE HINT MEMORY_BYTES CPU_SECONDS
// Limits its own memory and time, reads the mesh FILE as a file with the extension HINT, and writes
// it to standard output in the form of host/builder/mesh_import/wire.hpp. The tactree builder
// starts it; it is not meant for interactive use.

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "mesh_import/import_file.hpp"

namespace tactree::import_mesh {
namespace {

constexpr int kExitRefused = 1;
constexpr int kExitUsage = 2;
constexpr int kExitOutOfMemory = 3;

int output = -1;  // the original standard output

// AddressSanitizer reserves terabytes of address space, which RLIMIT_AS would prevent.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kLimitAddresses = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool kLimitAddresses = false;
#else
constexpr bool kLimitAddresses = true;
#endif
#else
constexpr bool kLimitAddresses = true;
#endif

bool set_limit(int resource, rlim_t limit) {
  const rlimit both{limit, limit};
  return ::setrlimit(static_cast<__rlimit_resource>(resource), &both) == 0;
}

bool set_limits(const char* memory_bytes, const char* cpu_seconds) {
  const rlim_t memory = std::strtoull(memory_bytes, nullptr, 10);
  const rlim_t seconds = std::strtoull(cpu_seconds, nullptr, 10);
  if (memory == 0 || seconds == 0) return false;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // end with the builder
  return (!kLimitAddresses || set_limit(RLIMIT_AS, memory)) && set_limit(RLIMIT_CPU, seconds) &&
         set_limit(RLIMIT_FSIZE, 0) && set_limit(RLIMIT_CORE, 0);
}

void report_out_of_memory() {
  builder::write_status(output, builder::WireStatus::kOutOfMemory, "");
  std::_Exit(kExitOutOfMemory);
}

int refuse(const char* text) {
  builder::write_status(output, builder::WireStatus::kRefused, text);
  return kExitRefused;
}

int run(int count, char** arguments) {
  if (count != 5) {
    std::fprintf(stderr, "usage: %s FILE HINT MEMORY_BYTES CPU_SECONDS\n", arguments[0]);
    return kExitUsage;
  }
  // Only the result goes to the original output; text that the library prints goes to standard
  // error.
  output = ::dup(STDOUT_FILENO);
  if (output < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return kExitUsage;
  if (!set_limits(arguments[3], arguments[4])) return refuse("resource limits cannot be set");
  std::set_new_handler(report_out_of_memory);
  try {
    return builder::import_file(arguments[1], arguments[2], output) ? 0 : kExitRefused;
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

}  // namespace
}  // namespace tactree::import_mesh

int main(int count, char** arguments) { return tactree::import_mesh::run(count, arguments); }
