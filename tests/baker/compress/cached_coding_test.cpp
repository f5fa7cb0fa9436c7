// Tests coding that is interrupted at each of its checkpoints in turn: the codes are the same.
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>

#include "baker/compress/kept_transfer.hpp"
#include "tests/support/heaps.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

constexpr std::size_t kCount = 6000, kHeaps = 24;
constexpr transfer::TransferShape kVisibilityShape{.order = 5, .outputs = 25, .visibility_bands = 9};

std::vector<float> heaps() {
  return testing::heaps(kCount, kHeaps, kVisibilityShape.size(), 31);
}

std::vector<std::byte> keptBytes(const CodedTransfer& coded) {
  ByteWriter out;
  write(coded, out);
  return out.take();
}

std::size_t entriesIn(const std::filesystem::path& folder) {
  std::size_t entries = 0;
  for (const auto& at : std::filesystem::recursive_directory_iterator(folder))
    entries += at.is_regular_file();
  return entries;
}

// Runs coding until it has written a checkpoint. The result is empty if it was stopped.
CodedTransfer codeUntilKept(Cache& cache, const std::vector<float>& vectors, const CodingSettings& settings) {
  std::stop_source stop;
  const std::jthread watch([&, stored = cache.figures().stored](const std::stop_token& over) {
    while (!over.stop_requested() && cache.figures().stored == stored) std::this_thread::yield();
    stop.request_stop();
  });
  Progress progress;
  return CachedCoding({progress, stop.get_token(), &cache}).code(vectors, kCount, kVisibilityShape, settings);
}

}  // namespace

TEST(CachedCoding, GoesOnFromEachOfItsCheckpointsToTheSameCodes) {
  const std::vector<float> vectors = heaps();
  // The second case has to search again, for fewer clusters; the third misses its error bound.
  for (const CodingSettings& settings :
       {CodingSettings{.bound = 0.004f},
        CodingSettings{.bound = 0.01f, .most_expanded_bytes = 40 * kVisibilityShape.size() * sizeof(float)},
        CodingSettings{.bound = 1e-5f, .shown_energy = 1.0}}) {
    const CodedTransfer whole = codeTransfer(vectors, kCount, kVisibilityShape, settings);
    const testing::TemporaryFolder folder;
    auto cache = Cache::open(folder.path());
    ASSERT_TRUE(cache);
    cache->setCheckpointEvery(0.0);
    CodedTransfer coded;
    int stopped = 0;
    for (; stopped < 200; ++stopped) {  // a run that does all over never gets beyond its first checkpoint
      coded = codeUntilKept(*cache, vectors, settings);
      if (!coded.cluster_of.empty()) break;
    }
    EXPECT_GE(stopped, 2) << "times; of some ten checkpoints, as the other thread finds them";
    EXPECT_EQ(keptBytes(coded), keptBytes(whole)) << "bound " << settings.bound;
  }
}

TEST(CachedCoding, LeavesNothingOnceWhatItLedToIsKept) {
  const std::vector<float> vectors = heaps();
  const testing::TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  cache->setCheckpointEvery(0.0);
  Progress progress;
  const BakeContext context{progress, {}, &*cache};
  CachedCoding coding(context);
  const CodedTransfer coded = coding.code(vectors, kCount, kVisibilityShape, {.bound = 0.01f});
  EXPECT_EQ(entriesIn(folder.path()), 1u) << "the codes";
  const auto before = cache->figures().stored;
  const CodedTransfer found = CachedCoding(context).code(vectors, kCount, kVisibilityShape, {.bound = 0.01f});
  EXPECT_EQ(cache->figures().stored, before) << "found";
  EXPECT_EQ(keptBytes(found), keptBytes(coded));
  coding.drop();
  EXPECT_EQ(entriesIn(folder.path()), 0u);
}

TEST(CachedCoding, WritesNoCheckpointsBeforeItIsTime) {
  const testing::TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  cache->setCheckpointEvery(1e9);
  Progress progress;
  CachedCoding({progress, {}, &*cache}).code(heaps(), kCount, kVisibilityShape, {.bound = 0.01f});
  EXPECT_EQ(cache->figures().stored, 1u) << "the codes alone";
}

}  // namespace lambent::baker
