#include <random>

#include <gtest/gtest.h>

#include "runtime/gpu/arena.hpp"

namespace lambent::gpu {

TEST(FreeList, GivesDisjointPiecesAndMergesThemAllBack) {
  constexpr std::uint64_t kBytes = 1 << 16;
  FreeList list(kBytes);
  std::mt19937 random(7);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> held;
  std::vector<bool> taken(kBytes, false);
  for (int step = 0; step < 4000; ++step) {
    if (held.empty() || random() % 3 != 0) {
      const std::uint64_t size = 16 * (1 + random() % 64);
      const auto offset = list.allocate(size);
      if (!offset) continue;
      for (std::uint64_t i = *offset; i < *offset + size; ++i) {
        ASSERT_FALSE(taken[i]);
        taken[i] = true;
      }
      held.emplace_back(*offset, size);
    } else {
      std::swap(held[random() % held.size()], held.back());
      const auto [offset, size] = held.back();
      held.pop_back();
      list.release(offset, size);
      for (std::uint64_t i = offset; i < offset + size; ++i) taken[i] = false;
    }
    std::uint64_t used = 0;
    for (const auto& [offset, size] : held) used += size;
    ASSERT_EQ(list.freeBytes(), kBytes - used);
  }
  for (const auto& [offset, size] : held) list.release(offset, size);
  EXPECT_EQ(list.largestFree(), kBytes);
}

TEST(FreeList, RefusesWhatDoesNotFit) {
  FreeList list(64);
  EXPECT_FALSE(list.allocate(65));
  EXPECT_EQ(list.allocate(64), 0u);
  EXPECT_FALSE(list.allocate(1));
}

}  // namespace lambent::gpu
