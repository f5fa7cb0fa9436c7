#include "runtime/base/threads.hpp"

#include <atomic>
#include <latch>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace lambent {

TEST(Parallel, DoesEveryPartOnceWhateverItIsWorth) {
  for (const std::size_t count : {0u, 1u, 2u, 7u, 1000u})
    for (const std::size_t worth : {0u, 1u, 3u, 5000u}) {
      std::vector<std::atomic<int>> done(count);
      inParallel(count, worth, [&](std::size_t i) { ++done[i]; });
      for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
    }
}

TEST(Parallel, CallsFromSeveralThreadsDoNotMix) {
  std::atomic<int> wrong = 0;
  std::vector<std::jthread> callers;
  for (std::size_t caller = 0; caller < 3; ++caller)
    callers.emplace_back([&, caller] {
      for (std::size_t round = 0; round < 2000; ++round) {
        std::vector<std::size_t> found(17, 0);  // goes at once; late helpers must not write to it
        inParallel(found.size(), 1, [&](std::size_t i) { found[i] += caller + i; });
        for (std::size_t i = 0; i < found.size(); ++i) wrong += found[i] != caller + i;
      }
    });
  callers.clear();
  EXPECT_EQ(wrong, 0);
}

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
