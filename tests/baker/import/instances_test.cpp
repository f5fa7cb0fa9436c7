// Tests EXT_mesh_gpu_instancing, whose instances become nodes.
#include <limits>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using testing::GltfWriter;
using testing::oneTriangle;
using testing::TemporaryFolder;

nlohmann::json& instances(GltfWriter& writer) {
  return writer.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
}

TEST(Instances, AreChildNodesWithTheirOwnPlaceTurnAndSize) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  writer.json["nodes"][0]["name"] = "tree";
  writer.json["nodes"][0]["translation"] = {10, 0, 0};
  instances(writer)["TRANSLATION"] = writer.add<float>("VEC3", 5126, {1, 2, 3, 4, 5, 6}, 3);
  // The rotations, in normalized bytes, are half a turn about Y and none.
  instances(writer)["ROTATION"] = writer.add<std::int8_t>("VEC4", 5120, {0, 127, 0, 0, 0, 0, 0, 127}, 4);
  writer.json["accessors"].back()["normalized"] = true;
  instances(writer)["SCALE"] = writer.add<float>("VEC3", 5126, {2, 2, 2, 1, 3, 1}, 3);
  const auto scene = importScene(writer.writeText(folder));
  ASSERT_TRUE(scene) << scene.error().line();
  ASSERT_EQ(scene->nodes.size(), 3u);
  EXPECT_EQ(scene->meshes.size(), 1u);
  EXPECT_EQ(scene->nodes[0].mesh, -1);
  EXPECT_EQ(scene->nodes[0].children, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(scene->nodes[1].name, "tree[0]");
  EXPECT_EQ(scene->nodes[2].name, "tree[1]");
  EXPECT_EQ(scene->nodes[2].mesh, 0);
  const auto world = gltf::worldTransforms(scene->nodes);
  EXPECT_LT(glm::length(glm::vec3(world[1] * glm::vec4(1, 1, 0, 1)) - glm::vec3(9, 4, 3)), 1e-5f);
  EXPECT_LT(glm::length(glm::vec3(world[2] * glm::vec4(1, 1, 0, 1)) - glm::vec3(15, 8, 6)), 1e-5f);
}

TEST(Instances, ThatMakeNoSenseAreRefusedByName) {
  TemporaryFolder folder;
  const auto refused = [&](auto spoil, const char* words) {
    GltfWriter writer = oneTriangle();
    instances(writer)["TRANSLATION"] = writer.add<float>("VEC3", 5126, {1, 2, 3, 4, 5, 6}, 3);
    spoil(writer);
    const std::string line = testing::refusal(writer, folder);
    EXPECT_NE(line.find(words), std::string::npos) << words << ": " << line;
    EXPECT_NE(line.find("node 0"), std::string::npos) << line;
  };
  refused(
      [](GltfWriter& w) {
        instances(w)["SCALE"] = w.add<float>("VEC3", 5126, {1, 1, 1}, 3);
      },
      "SCALE is there for 1 instances where others are for 2");
  refused(
      [](GltfWriter& w) {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        instances(w)["SCALE"] = w.add<float>("VEC3", 5126, {1, 1, 1, 1, nan, 1}, 3);
      },
      "SCALE of instance 1 is not finite");
  refused(
      [](GltfWriter& w) {
        instances(w)["ROTATION"] = w.add<float>("VEC3", 5126, {1, 1, 1, 1, 1, 1}, 3);
      },
      "wrong type");
  refused(
      [](GltfWriter& w) {  // a claim that costs the file nothing
        w.json["accessors"].push_back({{"componentType", 5126}, {"count", 2000000}, {"type", "VEC3"}});
        instances(w) = {{"TRANSLATION", w.json["accessors"].size() - 1}};
      },
      "more than 1048576 instances");
}

}  // namespace
}  // namespace lambent::baker
