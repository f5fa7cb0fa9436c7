#include <fstream>

#include "baker/sweep/sweep.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

nlohmann::json someBake() {
  return {{"seconds", 2.5}, {"stages", {{"import", 0.5}, {"direct light", 2.0}}}};
}

TEST(Store, FindsInTheNextRunWhatWasAdded) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "results.jsonl";
  {
    auto store = Store::open(file);
    ASSERT_TRUE(store);
    EXPECT_FALSE(store->find("a"));
    ASSERT_TRUE(store->add("a", "a bake", {{"seconds", 7.0}}));
    ASSERT_TRUE(store->add("a", "a bake", someBake()));  // takes its place
    EXPECT_EQ(store->added(), 2u);
  }
  const auto store = Store::open(file);
  ASSERT_TRUE(store);
  ASSERT_TRUE(store->find("a"));
  EXPECT_EQ(*store->find("a"), someBake());
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
    EXPECT_TRUE(store->find("a"));
    EXPECT_FALSE(store->find("b"));
    ASSERT_TRUE(store->add("c", "a bake", someBake()));
  }
  const auto store = Store::open(file);
  ASSERT_TRUE(store);
  EXPECT_TRUE(store->find("a"));
  EXPECT_TRUE(store->find("c"));
}

}  // namespace
}  // namespace lambent::baker
