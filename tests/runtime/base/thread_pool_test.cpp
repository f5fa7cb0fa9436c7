#include <latch>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "runtime/base/threads.hpp"

namespace lambent {

TEST(ThreadPool, WorkThatWaitsForOtherWorkIsAllDone) {
  ThreadPool threads;
  for (int round = 0; round < 50; ++round) {
    constexpr int kCount = 9;
    std::latch all_run(kCount), ended(kCount);
    std::mutex mutex;
    std::multiset<std::thread::id> on;
    for (int i = 0; i < kCount; ++i)
      threads.run([&] {
        all_run.arrive_and_wait();  // would wait for ever if one stood behind another
        {
          const std::lock_guard lock(mutex);
          on.insert(std::this_thread::get_id());
        }
        ended.count_down();
      });
    ended.wait();
    EXPECT_EQ(on.size(), 9u) << "each ran once";
    EXPECT_EQ(std::set<std::thread::id>(on.begin(), on.end()).size(), 9u) << "each on a thread of its own";
  }
}

TEST(ThreadPool, OneAfterTheOtherTakesNoMoreThreads) {
  ThreadPool kept;
  std::mutex mutex;
  std::set<std::thread::id> threads;
  for (int i = 0; i < 300; ++i) {
    std::latch ended(1);
    kept.run([&] {
      {
        const std::lock_guard lock(mutex);
        threads.insert(std::this_thread::get_id());
      }
      ended.count_down();
    });
    ended.wait();
  }
  // A thread has to come back before it is found: now and then another one was begun.
  EXPECT_LT(threads.size(), 100u);
}

}  // namespace lambent
