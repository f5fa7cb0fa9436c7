#include "baker/cache/cached_ranges.hpp"

#include <atomic>

#include <gtest/gtest.h>

#include "baker/jobs/parallel.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace lambent::baker;
using lambent::testing::TemporaryFolder;

// Work with a result of which each number is known, and a count of what was computed.
struct Squares {
  std::vector<std::uint64_t> values = std::vector<std::uint64_t>(1000, 0);
  std::atomic<std::size_t> computed = 0;
  std::size_t stop_after = 10'000;
  std::stop_source stop;

  CachedRanges run(Cache* cache, KeepWhen when = KeepWhen::Always) {
    const RangeWork work{
        .compute =
            [this](std::size_t begin, std::size_t end) {
              for (std::size_t i = begin; i < end; ++i) values[i] = i * i + 1;
              if (++computed >= stop_after) stop.request_stop();
            },
        .pack =
            [this](std::size_t begin, std::size_t end, ByteWriter& out) {
              out.addList(std::span<const std::uint64_t>(values).subspan(begin, end - begin));
            },
        .unpack = [this](
                      std::size_t begin, std::size_t end,
                      ByteReader& in) { return in.readInto(std::span(values).subspan(begin, end - begin)); }};
    return cachedRanges({cache, KeyMaker::ofStage("squares").key()}, values.size(), 7, stop.get_token(), work,
                        when);
  }
  void expectAll() const {
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], i * i + 1) << i;
  }
};

constexpr std::size_t kRanges = 143;

TEST(CachedRanges, GoOnWhereTheyWereStopped) {
  const TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  std::size_t found = 0;
  for (int run = 0;; ++run) {
    ASSERT_LT(run, 50);
    Squares squares;
    squares.stop_after = 20;
    const CachedRanges kept = squares.run(&*cache);
    EXPECT_EQ(kept.ranges, kRanges);
    EXPECT_TRUE(run == 0 || kept.found > found) << "what the runs before had finished";
    found = kept.found;
    if (!kept.finished) continue;
    EXPECT_EQ(found + squares.computed, kRanges);
    squares.expectAll();
    break;
  }
  Squares again;
  EXPECT_TRUE(again.run(&*cache).finished);
  EXPECT_EQ(again.computed, 0u);
  again.expectAll();
}

TEST(CachedRanges, ComputeAgainWhatWasInADamagedEntry) {
  const TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  for (int run = 0; run < 4; ++run) {
    Squares squares;
    squares.stop_after = 20;
    squares.run(&*cache);
  }
  std::vector<std::filesystem::path> entries;
  for (const auto& at : std::filesystem::recursive_directory_iterator(folder.path()))
    if (at.is_regular_file()) entries.push_back(at.path());
  ASSERT_EQ(entries.size(), 4u);
  std::filesystem::resize_file(entries[1], 100);
  Squares rest;
  const CachedRanges kept = rest.run(&*cache);
  EXPECT_TRUE(kept.finished);
  EXPECT_EQ(kept.found + rest.computed, kRanges);
  rest.expectAll();
  // The hole is filled, so that the entries after it are found again.
  Squares again;
  EXPECT_EQ(again.run(&*cache).found, kRanges);
  again.expectAll();
}

TEST(CachedRanges, AreWrittenAsCheckpointsOnlyWhenItIsTime) {
  const TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  cache->setCheckpointEvery(1e9);
  EXPECT_TRUE(Squares().run(&*cache, KeepWhen::Due).finished);
  EXPECT_EQ(cache->figures().stored, 0u);
  Squares stopped;
  stopped.stop_after = 50;
  EXPECT_FALSE(stopped.run(&*cache, KeepWhen::Due).finished);
  EXPECT_GT(cache->figures().stored, 0u);
  cache->setCheckpointEvery(0.0);
  Squares rest;
  EXPECT_GT(rest.run(&*cache, KeepWhen::Due).found, 0u);
  rest.expectAll();
  Squares again;
  EXPECT_EQ(again.run(&*cache, KeepWhen::Due).found, kRanges);
  dropRanges({&*cache, KeyMaker::ofStage("squares").key()}, again.values.size(), 7);
  EXPECT_EQ(Squares().run(&*cache, KeepWhen::Due).found, 0u);
}

TEST(CachedRanges, DoWithoutACache) {
  Squares squares;
  const CachedRanges kept = squares.run(nullptr);
  EXPECT_TRUE(kept.finished);
  EXPECT_EQ(squares.computed, kRanges);
  squares.expectAll();
}

TEST(Bytes, NeverReadPastTheirEnd) {
  ByteWriter out;
  out.add(std::uint32_t{7});
  out.addList(std::vector<float>{1.0f, 2.0f, 3.0f});
  out.addText("end");
  for (std::size_t cut = 0; cut <= out.size(); ++cut) {
    ByteReader in(out.bytes().first(cut));
    std::uint32_t seven = 0;
    std::vector<float> list;
    std::string text;
    const bool all = in.read(seven) && in.readList(list) && in.readText(text) && in.atEnd();
    EXPECT_EQ(all, cut == out.size());
  }
  ByteWriter lies;  // a length that would not fit into memory
  lies.add(~std::uint64_t{0});
  ByteReader in(lies.bytes());
  std::vector<double> list;
  EXPECT_FALSE(in.readList(list));
  EXPECT_FALSE(in.ok());
}

}  // namespace
