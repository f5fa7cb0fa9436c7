// Tests that positions of a bundle count from its origin, to all digits of a place in the world.
#include <gtest/gtest.h>

#include "tests/runtime/bundle/sample_of_every_list.hpp"

namespace lambent::bundle {

TEST_F(BundleFile, StandsInTheWorldToAllDigitsAndCountsFromAnyOrigin) {
  Sample sample = sampleOfEveryList();
  Description& d = sample.description;
  d.origin = {5e6, 1024.0, -0.5};
  const glm::vec4 place = d.nodes[0].parent_from_node[3];
  const glm::vec3 rest = d.groups[0].rest_translation;
  ASSERT_TRUE(write(path_, d, sample.blobs));
  auto reader = Reader::open(path_);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_EQ(reader->description().origin, d.origin);
  EXPECT_EQ(reader->description().nodes[0].parent_from_node[3], place);
  EXPECT_EQ(reader->description().nodes[1].parent_from_node, d.nodes[1].parent_from_node);
  EXPECT_EQ(reader->description().groups[0].rest_translation, rest);
  EXPECT_TRUE(reader->checkAll());
  reader->countFrom({5e6 - 8.0, 1024.0, 0.0});
  EXPECT_EQ(reader->description().nodes[0].parent_from_node[3], place + glm::vec4(8.0f, 0.0f, -0.5f, 0.0f));
  EXPECT_EQ(reader->description().groups[0].rest_translation, rest + glm::vec3(8.0f, 0.0f, -0.5f));
}

TEST_F(BundleFile, WithoutAnOriginCountsFromAnotherBelowANodeOfItsOwn) {
  const Sample sample = sampleOfEveryList();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  auto reader = Reader::open(path_);
  ASSERT_TRUE(reader) << reader.error().line();
  reader->countFrom({-2.0, 0.0, 0.0});
  const Description& d = reader->description();
  ASSERT_EQ(d.nodes.size(), sample.description.nodes.size() + 1);
  EXPECT_EQ(d.nodes[0].parent_from_node, sample.description.nodes[0].parent_from_node);
  EXPECT_EQ(gltf::worldTransforms(d.nodes)[0][3],
            sample.description.nodes[0].parent_from_node[3] + glm::vec4(2.0f, 0.0f, 0.0f, 0.0f));
  EXPECT_EQ(d.roots, std::vector<std::int32_t>{static_cast<std::int32_t>(d.nodes.size()) - 1});
}

}  // namespace lambent::bundle
