// Tests the list of passes: what a pass reads, an earlier pass has written.
#include "runtime/frame/pass_list.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <typeindex>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

using Infos = std::vector<PassInfo>;

// Returns a pass and a type for each resource that is read before it is written, or is never written.
std::vector<std::string> readTooEarly(const Infos& passes) {
  std::vector<std::string> wrong;
  std::set<std::type_index> written, ever;
  for (const PassInfo& pass : passes) ever.insert(pass.writes.begin(), pass.writes.end());
  for (const PassInfo& pass : passes) {
    for (const std::type_index type : pass.reads)
      if (!written.contains(type)) wrong.push_back(std::string(pass.name) + " reads " + type.name());
    for (const std::type_index type : pass.reads_before)
      if (!ever.contains(type)) wrong.push_back(std::string(pass.name) + " never gets " + type.name());
    written.insert(pass.writes.begin(), pass.writes.end());
  }
  return wrong;
}

class PassListTest : public testing::GpuTest {
 protected:
  static Infos infos() {
    const auto environment = lighting::Environment::create({});
    EXPECT_TRUE(environment);
    Blackboard board;
    const Result<PassList> list = makePassList({}, *environment, board);
    EXPECT_TRUE(list) << list.error().line();
    Infos infos;
    for (const auto* passes : {&list->step, &list->picture})
      for (const auto& pass : *passes) infos.push_back(pass->info());
    return infos;
  }
};

TEST_F(PassListTest, EveryPassReadsWhatPassesBeforeItWrote) {
  EXPECT_EQ(readTooEarly(infos()), std::vector<std::string>());
}

TEST_F(PassListTest, OverlaysBeforeTheUploadWouldReadTooEarly) {
  Infos list = infos();
  std::swap(list.front(), list.back());
  EXPECT_FALSE(readTooEarly(list).empty());
}

}  // namespace
}  // namespace lambent::frame
