#include "thread_priority.hpp"

#include <pthread.h>
#include <sched.h>

namespace tactree::client {

bool prefer_this_thread() {
  sched_param parameters{};
  parameters.sched_priority = kLinkPriority;
  // Round robin: two links on one core share it.
  return pthread_setschedparam(pthread_self(), SCHED_RR, &parameters) == 0;
}

}  // namespace tactree::client
