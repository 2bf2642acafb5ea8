#include "thread_priority.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <thread>

namespace tactree::client {
namespace {

TEST(ThreadPriority, IsRealTimeOrUnchanged) {
  bool preferred = false;
  int before = -1;
  int policy = -1;
  sched_param parameters{};
  std::thread([&] {
    ASSERT_EQ(pthread_getschedparam(pthread_self(), &before, &parameters), 0);
    preferred = prefer_this_thread();
    ASSERT_EQ(pthread_getschedparam(pthread_self(), &policy, &parameters), 0);
  }).join();
  EXPECT_EQ(policy, preferred ? SCHED_RR : before);
  if (preferred) {
    EXPECT_EQ(parameters.sched_priority, kLinkPriority);
  }
}

}  // namespace
}  // namespace tactree::client
