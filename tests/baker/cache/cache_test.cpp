#include "baker/cache/cache.hpp"

#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.hpp"

namespace {

using namespace lambent::baker;
using lambent::testing::TemporaryFolder;
namespace fs = std::filesystem;

Key keyOf(std::uint64_t number) {
  return KeyMaker().add(number).key();
}

// Returns noise, which cannot be compressed, or a pattern that can.
std::vector<std::byte> contents(std::uint64_t seed, std::size_t size, bool noise = true) {
  std::vector<std::byte> bytes(size);
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::byte>((noise ? random() : seed + i / 64) & 0xff);
  return bytes;
}

std::vector<fs::path> filesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& at : fs::recursive_directory_iterator(folder))
    if (at.is_regular_file()) files.push_back(at.path());
  return files;
}

Cache openCache(const fs::path& folder, std::uint64_t most_bytes = kCacheBytes) {
  auto cache = Cache::open(folder, most_bytes);
  EXPECT_TRUE(cache) << cache.error().line();
  return std::move(*cache);
}

TEST(Key, TellsListsApartByTheirLengths) {
  const std::vector<std::uint32_t> one = {1}, two = {2}, both = {1, 2}, none;
  EXPECT_NE(KeyMaker().addList(one).addList(two).key(), KeyMaker().addList(both).addList(none).key());
  EXPECT_NE(KeyMaker().addText("ab").addText("c").key(), KeyMaker().addText("a").addText("bc").key());
  EXPECT_EQ(KeyMaker().addList(both).key(), KeyMaker().addList(both).key());
}

TEST(Key, OfAStageDependsOnTheProgram) {
  EXPECT_EQ(programDigest().size(), 64u);
  KeyMaker without;
  without.addText("rays");
  EXPECT_NE(KeyMaker::ofStage("rays").key(), without.key());
  EXPECT_NE(KeyMaker::ofStage("rays").key(), KeyMaker::ofStage("coding").key());
  EXPECT_EQ(KeyMaker::ofStage("rays").key().hex().size(), 32u);
}

TEST(Bytes, NeverReadPastTheirEnd) {
  ByteWriter out;
  out.add(std::uint32_t{7});
  out.addList(std::vector<float>{1.0f, 2.0f, 3.0f});
  write(std::string("end"), out);
  for (std::size_t cut = 0; cut <= out.size(); ++cut) {
    ByteReader in(out.bytes().first(cut));
    std::uint32_t seven = 0;
    std::vector<float> list;
    std::string text;
    const bool all = in.read(seven) && in.readList(list) && in.readList(text) && in.atEnd();
    EXPECT_EQ(all, cut == out.size());
  }
  ByteWriter lies;  // a length that would not fit into memory
  lies.add(~std::uint64_t{0});
  ByteReader in(lies.bytes());
  std::vector<double> list;
  EXPECT_FALSE(in.readList(list));
  EXPECT_FALSE(in.ok());
}

TEST(Cache, FindsWhatWasPut) {
  const TemporaryFolder folder;
  const auto noise = contents(1, 100'000), pattern = contents(2, 100'000, false), nothing = contents(3, 0);
  {
    Cache cache = openCache(folder.path() / "made" / "on the way");
    cache.put(keyOf(1), noise), cache.put(keyOf(2), pattern), cache.put(keyOf(3), nothing);
    EXPECT_EQ(cache.notice(), "");
    EXPECT_LT(cache.figures().bytes_written, 150'000u) << "patterns are kept compressed";
  }
  Cache cache = openCache(folder.path() / "made" / "on the way");
  EXPECT_EQ(cache.find(keyOf(1)), noise);
  EXPECT_EQ(cache.find(keyOf(2)), pattern);
  EXPECT_EQ(cache.find(keyOf(3)), nothing);
  EXPECT_FALSE(cache.find(keyOf(4)));
  cache.drop(keyOf(1));
  EXPECT_FALSE(cache.find(keyOf(1)));
  cache.setReading(false);
  EXPECT_FALSE(cache.find(keyOf(2)));
}

TEST(Cache, TakesDamagedAndTruncatedEntriesForAbsentAndRemovesThem) {
  const TemporaryFolder folder;
  Cache cache = openCache(folder.path());
  const auto bytes = contents(1, 300);
  cache.put(keyOf(1), bytes);
  const fs::path file = filesIn(folder.path()).at(0);
  std::string whole(fs::file_size(file), '\0');
  std::ifstream(file, std::ios::binary).read(whole.data(), static_cast<std::streamsize>(whole.size()));
  const auto write = [&](const std::string& text) { std::ofstream(file, std::ios::binary) << text; };

  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    write(damaged);
    ASSERT_FALSE(cache.find(keyOf(1))) << "byte " << at;
    ASSERT_FALSE(fs::exists(file)) << "byte " << at;
    write(whole.substr(0, at));
    ASSERT_FALSE(cache.find(keyOf(1))) << "cut off at " << at;
    ASSERT_FALSE(fs::exists(file)) << "cut off at " << at;
  }
  write(whole + "x");
  EXPECT_FALSE(cache.find(keyOf(1))) << "more than there should be";
  // Another entry's file under this name is no entry of it.
  write(whole);
  cache.put(keyOf(2), bytes);
  for (const fs::path& other : filesIn(folder.path()))
    if (other != file) fs::copy_file(file, other, fs::copy_options::overwrite_existing);
  EXPECT_FALSE(cache.find(keyOf(2)));
  EXPECT_EQ(cache.find(keyOf(1)), bytes);
}

TEST(Cache, LetsGoOfWhatWasUsedLongestAgo) {
  const TemporaryFolder folder;
  {
    Cache before = openCache(folder.path());
    for (std::uint64_t k = 0; k < 10; ++k) before.put(keyOf(k), contents(k, 10'000));
    EXPECT_TRUE(before.find(keyOf(0)));  // used again, and so younger than 1
  }
  Cache cache = openCache(folder.path(), 80'000);
  cache.put(keyOf(100), contents(100, 10'000));  // 110 KB in all, of which 72 KB may stay
  EXPECT_TRUE(cache.has(keyOf(0)));
  for (std::uint64_t k = 1; k < 10; ++k) EXPECT_EQ(cache.has(keyOf(k)), k > 4) << k;
  EXPECT_TRUE(cache.has(keyOf(100)));
  EXPECT_EQ(cache.figures().evicted, 4u);
}

TEST(Cache, KeepsWhatTheRunningBakeUses) {
  const TemporaryFolder folder;
  {
    Cache before = openCache(folder.path());
    for (std::uint64_t k = 0; k < 4; ++k) before.put(keyOf(k), contents(k, 10'000));
  }
  Cache cache = openCache(folder.path(), 20'000);
  EXPECT_TRUE(cache.find(keyOf(1)));
  for (std::uint64_t k = 10; k < 20; ++k) cache.put(keyOf(k), contents(k, 10'000));
  EXPECT_FALSE(cache.has(keyOf(0)));
  EXPECT_TRUE(cache.has(keyOf(1)));
  for (std::uint64_t k = 10; k < 20; ++k) EXPECT_TRUE(cache.has(keyOf(k)));
  cache.beginBake();
  cache.put(keyOf(30), contents(30, 10'000));
  EXPECT_TRUE(cache.has(keyOf(30)));
  EXPECT_FALSE(cache.has(keyOf(10)));
}

TEST(Cache, IsSafeForManyThreadsAndTwoProcesses) {
  const TemporaryFolder folder;
  constexpr std::uint64_t kKeys = 24;
  const auto work = [&](std::uint64_t seed) {
    Cache cache = openCache(folder.path(), 200'000);  // a third of all: eviction runs all the while
    std::atomic<int> wrong = 0;
    std::vector<std::jthread> threads;
    for (std::uint64_t t = 0; t < 3; ++t)
      threads.emplace_back([&, t] {
        std::mt19937_64 random(seed * 10 + t);
        for (int i = 0; i < 300; ++i) {
          const std::uint64_t k = random() % kKeys;
          if (const auto got = cache.find(keyOf(k)); got && *got != contents(k, 25'000)) ++wrong;
          if (i % 3 == 0) cache.put(keyOf(k), contents(k, 25'000));
          if (i % 50 == 0) cache.beginBake();
        }
      });
    threads.clear();
    return wrong == 0 && cache.figures().damaged == 0 && cache.notice().empty();
  };
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work(1) ? 0 : 1);
  EXPECT_TRUE(work(2));
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(Cache, GoesOnWithoutAFolderToWriteTo) {
  const TemporaryFolder folder;
  Cache cache = openCache(folder.path() / "cache");
  cache.put(keyOf(1), contents(1, 1000));
  fs::remove_all(folder.path() / "cache");
  std::ofstream(folder.path() / "cache") << "a file in its place";  // also where the tester is root
  cache.put(keyOf(2), contents(2, 1000));
  EXPECT_NE(cache.notice(), "");
  cache.put(keyOf(3), contents(3, 1000));
  EXPECT_FALSE(cache.find(keyOf(2)));
  EXPECT_FALSE(Cache::open(folder.path() / "cache"));
}

}  // namespace
