// Tests that unfinished bakes are found again once no process works on them.
#include "baker/pipeline/journal.hpp"

#include <fstream>

#include "tests/baker/pipeline/pipeline_test.hpp"

namespace lambent::baker {
namespace {

class JournalTest : public testing::PipelineTest {
 protected:
  BakeRequest request(const std::string& name) const {
    return {.scene = folder / (name + ".glb"),
            .output = folder / (name + ".lmb.glb"),
            .options = {},
            .import = {}};
  }
};

}  // namespace

TEST_F(JournalTest, KeepsEveryOptionOfARequest) {
  BakeRequest asked = request("a");
  asked.options = {.quality = Quality::High,
                   .order = 6,
                   .glossy_order = 4,
                   .rays = 333,
                   .bounces = 3,
                   .picture_bound = 0.025f,
                   .error_bound = 0.0125f,
                   .max_edge_m = 0.1f,
                   .neighborhood_grid = {3, 4, 5},
                   .refine_bound = 0.07f,
                   .fit = false,
                   .light_probes = 9,
                   .volume_grid = {6, 7, 8},
                   .effects = "diffuse,glossy",
                   .threads = 2,
                   .memory_bytes = 12345678901};
  asked.import.allow_outside = true;
  const auto read = readRequest(requestText(asked));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene, asked.scene);
  EXPECT_EQ(read->output, asked.output);
  EXPECT_EQ(read->options.settings(), asked.options.settings());
  EXPECT_EQ(read->options.threads, asked.options.threads);
  EXPECT_EQ(read->options.memory_bytes, asked.options.memory_bytes);
  EXPECT_TRUE(read->import.allow_outside);
  EXPECT_EQ(requestKey(*read), requestKey(asked));
}

TEST_F(JournalTest, WhatIsCutOffOrOfAnotherVersionIsNoRequest) {
  const std::string text = requestText(request("a"));
  for (std::size_t length = 0; length + 2 < text.size(); length += 7)
    EXPECT_FALSE(readRequest(text.substr(0, length)));
  EXPECT_FALSE(readRequest("[]"));
  EXPECT_FALSE(readRequest(R"({"version": 99})"));
}

TEST_F(JournalTest, ABakeIsUnfinishedOnlyOnceItEndedWithoutBeingDone) {
  const Journal journal(folder / "journal");
  EXPECT_TRUE(journal.unfinished().empty());
  {
    Journal::Entry running = journal.begin(request("a"));
    Journal::Entry finished = journal.begin(request("b"));
    finished.done();
    EXPECT_TRUE(journal.unfinished().empty()) << "one is still worked at, one is done";
  }
  const auto left = journal.unfinished();
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].scene, request("a").scene);
  journal.begin(left[0]).done();
  EXPECT_TRUE(journal.unfinished().empty());
}

TEST_F(JournalTest, SaysThatItCannotBeWritten) {
  std::ofstream(folder / "file") << "no folder";
  const Journal under_a_file(folder / "file" / "journal"), is_a_file(folder / "file");
  for (const Journal& journal : {under_a_file, is_a_file}) {
    const Journal::Entry entry = journal.begin(request("a"));
    ASSERT_TRUE(entry.error());
    EXPECT_NE(entry.error()->line().find("file"), std::string::npos) << entry.error()->line();
  }
  const Journal journal(folder / "journal");
  const Journal::Entry entry = journal.begin(request("a"));
  EXPECT_FALSE(entry.error());
  EXPECT_FALSE(journal.begin(request("a")).error()) << "another bakes the same: that is no error";
}

}  // namespace lambent::baker
