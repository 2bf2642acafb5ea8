#include "interruption.hpp"

#include <csignal>

namespace tactree::cli {
namespace {

volatile std::sig_atomic_t ending = 0;

void note(int) { ending = 1; }

}  // namespace

void watch_interruption() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

bool interrupted() { return ending != 0; }

}  // namespace tactree::cli
