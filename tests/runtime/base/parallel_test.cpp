#include "runtime/base/parallel.hpp"

#include <atomic>
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

}  // namespace lambent
