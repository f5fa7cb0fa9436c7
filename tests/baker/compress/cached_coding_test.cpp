// Tests that transfers are coded once, and that the cache keeps them only until all of them are.
#include <filesystem>

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

}  // namespace

TEST(CachedCoding, FindsWhatWasCodedUntilItIsDropped) {
  const std::vector<float> vectors = heaps();
  const testing::TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
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

}  // namespace lambent::baker
