// Tests the import of animations: keyframes as in the file, or a reason for refusing them.
#include <limits>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using gltf::AnimationChannel;
using nlohmann::json;
using testing::GltfWriter;
using testing::oneTriangle;
using testing::TemporaryFolder;

void animate(GltfWriter& writer, const char* path, const std::vector<float>& times,
             const std::vector<float>& values, const char* interpolation = "LINEAR") {
  const bool turn = std::string(path) == "rotation";
  json& animation = writer.json["animations"][0];
  animation["name"] = "walk";
  animation["samplers"].push_back(
      {{"input", writer.add<float>("SCALAR", 5126, times, 1)},
       {"output", writer.add<float>(turn ? "VEC4" : "VEC3", 5126, values, turn ? 4 : 3)},
       {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", 0}, {"path", path}}}});
}

TEST(Animations, KeepTheirKeysAndThePartsOfTheNodesThatTheyMove) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["nodes"][0]["translation"] = {1, 2, 3};
  writer.json["nodes"][0]["scale"] = {-2, 0, 2};  // a matrix could not give this back
  animate(writer, "translation", {0.0f, 0.5f, 2.0f}, {0, 0, 0, 1, 0, 0, 1, 1, 0}, "STEP");
  animate(writer, "rotation", {0.0f, 1.0f}, {0, 0, 0, 2, 0, 1, 0, 0});
  animate(writer, "scale", {1.0f}, {9, 9, 9, 1, 2, 3, 9, 9, 9}, "CUBICSPLINE");
  const auto scene = importScene(writer.writeText(folder));
  ASSERT_TRUE(scene) << scene.error().line();
  ASSERT_EQ(scene->animations.size(), 1u);
  EXPECT_EQ(scene->animations[0].name, "walk");
  const auto& channels = scene->animations[0].channels;
  ASSERT_EQ(channels.size(), 3u);
  EXPECT_EQ(channels[0].path, AnimationChannel::Path::Translation);
  EXPECT_EQ(channels[0].interpolation, AnimationChannel::Interpolation::Step);
  EXPECT_EQ(channels[0].times_s, (std::vector<float>{0.0f, 0.5f, 2.0f}));
  EXPECT_EQ(channels[0].values, (std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0}));
  EXPECT_EQ(channels[1].values, (std::vector<float>{0, 0, 0, 1, 0, 1, 0, 0}));  // made unit
  EXPECT_EQ(channels[2].interpolation, AnimationChannel::Interpolation::Cubic);
  EXPECT_EQ(channels[2].values.size(), 9u);
  const gltf::Node& node = scene->nodes.at(0);
  EXPECT_TRUE(node.animated);
  ASSERT_TRUE(node.trs);
  EXPECT_EQ(node.trs->scale, glm::vec3(-2, 0, 2));
  EXPECT_EQ(node.parent_from_node, node.trs->matrix());
}

TEST(Animations, TakeAMatrixApartUnlessItShears) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  animate(writer, "translation", {0.0f}, {0, 0, 0});
  writer.json["nodes"][0]["matrix"] = {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1};
  const auto scene = importScene(writer.writeText(folder));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->nodes[0].trs->translation, glm::vec3(5, 6, 7));
  EXPECT_EQ(scene->nodes[0].trs->scale, glm::vec3(2.0f));
  writer.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const Scene sheared = testing::imported(writer, folder);
  EXPECT_TRUE(sheared.animations.empty());
  EXPECT_FALSE(sheared.nodes[0].animated);
  ASSERT_EQ(sheared.warnings.size(), 1u);
  EXPECT_NE(sheared.warnings[0].find("node 0 is animated but has a matrix with shear"), std::string::npos);
}

TEST(Animations, ThatMakeNoSenseAreLeftOutByName) {
  TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto leftOut = [&](const char* path, const std::vector<float>& times,
                           const std::vector<float>& values, const char* words,
                           const char* interpolation = "LINEAR") {
    GltfWriter writer = oneTriangle();
    animate(writer, path, times, values, interpolation);
    const Scene scene = testing::imported(writer, folder);
    EXPECT_TRUE(scene.animations.empty()) << words;
    EXPECT_FALSE(scene.nodes.at(0).animated) << words;
    ASSERT_EQ(scene.warnings.size(), 1u) << words;
    EXPECT_NE(scene.warnings[0].find(words), std::string::npos) << scene.warnings[0];
    EXPECT_NE(scene.warnings[0].find("animation 0, channel 0"), std::string::npos);
  };
  leftOut("scale", {0, 2, 1}, {1, 1, 1, 1, 1, 1, 1, 1, 1}, "times do not rise at key 2");
  leftOut("scale", {0, 0}, {1, 1, 1, 1, 1, 1}, "times do not rise at key 1");
  leftOut("scale", {nan, 1}, {1, 1, 1, 1, 1, 1}, "time of key 0");
  leftOut("scale", {-1, 1}, {1, 1, 1, 1, 1, 1}, "time of key 0");
  leftOut("scale", {0, 1}, {1, 1, 1}, "1 values for 2 keys");
  leftOut("scale", {0}, {1, 1, 1}, "1 values for 1 keys", "CUBICSPLINE");
  leftOut("scale", {0}, {1, nan, 1}, "value 0 is not finite");
  leftOut("rotation", {0}, {0, 0, 0, 0}, "rotation of key 0 is zero");
  leftOut("scale", {}, {}, "no keys");
  GltfWriter twice = oneTriangle();
  animate(twice, "scale", {0}, {1, 1, 1});
  animate(twice, "scale", {0}, {1, 1, 1});
  const Scene scene = testing::imported(twice, folder);
  EXPECT_EQ(scene.animations.at(0).channels.size(), 1u);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

}  // namespace
}  // namespace lambent::baker
