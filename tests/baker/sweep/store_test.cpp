#include "baker/sweep/store.hpp"

#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

BakeRow someBake() {
  return {.seconds = 2.5,
          .least_seconds = 2.0,
          .most_seconds = 3.0,
          .runs = 3,
          .stages = {{"import", 0.5}, {"direct light", 2.0}},
          .bytes = 1000,
          .transfer_bytes = 400,
          .vertices = 20,
          .parts = {0.01, 0.02, 0.03}};
}

TEST(Store, FindsInTheNextRunWhatWasAdded) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "results.jsonl";
  {
    auto store = Store::open(file);
    ASSERT_TRUE(store);
    EXPECT_FALSE(store->find<BakeRow>("a"));
    BakeRow earlier = someBake();
    earlier.seconds = 7.0;
    ASSERT_TRUE(store->add("a", "a bake", earlier));
    ASSERT_TRUE(store->add("a", "a bake", someBake()));  // takes its place
    EXPECT_EQ(store->added(), 2u);
  }
  const auto store = Store::open(file);
  ASSERT_TRUE(store);
  const auto row = store->find<BakeRow>("a");
  ASSERT_TRUE(row);
  EXPECT_EQ(row->seconds, 2.5);
  EXPECT_EQ(row->runs, 3);
  EXPECT_EQ(row->stages, someBake().stages);
  EXPECT_EQ(row->parts.interpolation, 0.03);
  EXPECT_EQ(store->added(), 0u);
}

TEST(Store, LeavesOutALineThatWasCutShortAndGoesOnBehindIt) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "results.jsonl";
  {
    auto store = Store::open(file);
    ASSERT_TRUE(store && store->add("a", "a bake", someBake()));
  }
  std::ofstream(file, std::ios::app) << R"({"key": "b", "row": {"seco)";
  {
    auto store = Store::open(file);
    ASSERT_TRUE(store);
    EXPECT_TRUE(store->find<BakeRow>("a"));
    EXPECT_FALSE(store->find<BakeRow>("b"));
    ASSERT_TRUE(store->add("c", "a bake", someBake()));
  }
  const auto store = Store::open(file);
  ASSERT_TRUE(store);
  EXPECT_TRUE(store->find<BakeRow>("a"));
  EXPECT_TRUE(store->find<BakeRow>("c"));
}

}  // namespace
}  // namespace lambent::baker
