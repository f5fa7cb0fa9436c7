#include "baker/jobs/stage.hpp"

#include <atomic>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace {

using namespace lambent::baker;
using lambent::testing::TemporaryFolder;

// Does work whose results are known, and counts what was computed.
struct Squares {
  std::vector<std::uint64_t> values = std::vector<std::uint64_t>(1000, 0);
  std::atomic<std::size_t> computed = 0;
  std::size_t stop_after = 10'000;
  std::stop_source stop;
  Progress progress;

  std::optional<StageFigures> run(Cache* cache, KeepWhen when = KeepWhen::Always) {
    const auto compute = [this](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) values[i] = i * i + 1;
      if (++computed >= stop_after) stop.request_stop();
    };
    return runStage({.name = "squares",
                     .unit = "numbers",
                     .count = values.size(),
                     .grain = 7,
                     .writes = {rowsOf(values)},
                     .compute = compute,
                     .keep = when},
                    {progress, stop.get_token(), cache, key()});
  }
  static Key key() { return KeyMaker::ofStage("squares").key(); }
  void expectAll() const {
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], i * i + 1) << i;
  }
};

constexpr std::size_t kItems = 1000;

TEST(Stages, GoOnWhereTheyWereStopped) {
  const TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  std::uint64_t counted = 0;
  for (int run = 0;; ++run) {
    ASSERT_LT(run, 50);
    Squares squares;
    squares.stop_after = 20;
    const auto figures = squares.run(&*cache);
    EXPECT_GT(squares.progress.now().done, counted) << "found and computed items count alike";
    counted = squares.progress.now().done;
    if (!figures) continue;
    EXPECT_GT(run, 2);
    EXPECT_EQ(figures->found + figures->computed, kItems);
    EXPECT_EQ(counted, kItems);
    squares.expectAll();
    break;
  }
  Squares again;
  const auto figures = again.run(&*cache);
  ASSERT_TRUE(figures);
  EXPECT_EQ(figures->found, kItems);
  EXPECT_EQ(again.computed, 0u);
  again.expectAll();
}

TEST(Stages, ComputeAgainWhatWasInADamagedEntry) {
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
  const auto figures = rest.run(&*cache);
  ASSERT_TRUE(figures);
  EXPECT_EQ(figures->found + figures->computed, kItems);
  rest.expectAll();
  // Filling the gap makes the entries after it available again.
  Squares again;
  EXPECT_EQ(again.run(&*cache)->found, kItems);
  again.expectAll();
}

TEST(Stages, AreWrittenAsCheckpointsOnlyWhenItIsTime) {
  const TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  cache->setCheckpointEvery(1e9);
  EXPECT_TRUE(Squares().run(&*cache, KeepWhen::Due));
  EXPECT_EQ(cache->figures().stored, 0u);
  Squares stopped;
  stopped.stop_after = 50;
  EXPECT_FALSE(stopped.run(&*cache, KeepWhen::Due));
  EXPECT_GT(cache->figures().stored, 0u);
  cache->setCheckpointEvery(0.0);
  Squares rest;
  EXPECT_GT(rest.run(&*cache, KeepWhen::Due)->found, 0u);
  rest.expectAll();
  Squares again;
  EXPECT_EQ(again.run(&*cache, KeepWhen::Due)->found, kItems);
  dropStage({again.progress, {}, &*cache, Squares::key()}, kItems, 7);
  EXPECT_EQ(Squares().run(&*cache, KeepWhen::Due)->found, 0u);
}

TEST(Stages, KeepRowsOfItemsThatHaveOne) {
  // Items from 10 on have a row of three values in one list, all of them one in the middle of another.
  std::vector<float> rows(3 * 20, 0.0f), all(100, 0.0f);
  const std::vector<Output> writes = {rowsOf(rows, 3, -10), rowsOf(all, 1, 5)};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<float>(i);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<float>(i);
  ByteWriter out;
  for (const Output& output : writes) output.write(8, 12, out);
  const auto rows_before = rows, all_before = all;
  std::fill_n(rows.begin(), 6, -1.0f);
  std::fill_n(all.begin() + 13, 4, -1.0f);
  ByteReader in(out.bytes());
  for (const Output& output : writes) EXPECT_TRUE(output.read(8, 12, in));
  EXPECT_TRUE(in.atEnd());
  EXPECT_EQ(rows, rows_before);
  EXPECT_EQ(all, all_before);
}

}  // namespace
