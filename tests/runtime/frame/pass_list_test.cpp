// Tests the list of passes: what a pass reads, an earlier pass has written.
#include <set>
#include <string>
#include <typeindex>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/frame/frame_pass.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {

using PassListTest = lambent::testing::GpuTest;

TEST_F(PassListTest, EveryPassReadsWhatPassesBeforeItWrote) {
  const auto environment = lighting::Environment::create({});
  ASSERT_TRUE(environment);
  Blackboard board;
  const Result<PassList> list = makePassList({}, *environment, board);
  ASSERT_TRUE(list) << list.error().line();
  std::vector<PassInfo> passes;
  for (const auto* some : {&list->step, &list->picture})
    for (const auto& pass : *some) passes.push_back(pass->info());
  std::set<std::type_index> written, ever;
  for (const PassInfo& pass : passes) ever.insert(pass.writes.begin(), pass.writes.end());
  for (const PassInfo& pass : passes) {
    for (const std::type_index type : pass.reads)
      EXPECT_TRUE(written.contains(type)) << pass.name << " reads " << type.name();
    for (const std::type_index type : pass.reads_before)
      EXPECT_TRUE(ever.contains(type)) << pass.name << " never gets " << type.name();
    written.insert(pass.writes.begin(), pass.writes.end());
  }
}

}  // namespace lambent::frame
