#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/base/threads.hpp"

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

}  // namespace lambent
