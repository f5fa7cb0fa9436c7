// Tests morph targets and skins at rest: vertices are where the formulas of glTF put them.
#include <limits>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using testing::GltfWriter;
using testing::imported;
using testing::oneTriangle;
using testing::TemporaryFolder;

// Returns the positions of the mesh that a node draws, in world space.
std::vector<glm::vec3> worldPositions(const Scene& scene, std::size_t node, std::size_t primitive = 0) {
  const glm::mat4 world = gltf::worldTransforms(scene.nodes).at(node);
  std::vector<glm::vec3> out;
  for (const glm::vec3& p : scene.meshes.at(static_cast<std::size_t>(scene.nodes.at(node).mesh))
                                .primitives.at(primitive)
                                .mesh.positions)
    out.emplace_back(world * glm::vec4(p, 1.0f));
  return out;
}

void expectNear(const std::vector<glm::vec3>& found, const std::vector<glm::vec3>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_LT(glm::distance(found[i], expected[i]), 1e-5f) << i;
}

TEST(MorphTargets, MoveVerticesByTheWeightsOfTheNodeOrElseOfTheMesh) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.primitive()["attributes"]["NORMAL"] =
      writer.add<float>("VEC3", 5126, {0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  writer.primitive()["targets"] = {
      {{"POSITION", writer.add<float>("VEC3", 5126, {0, 0, 0, 2, 0, 0, 0, 0, 0}, 3)},
       {"NORMAL", writer.add<float>("VEC3", 5126, {0, 0, 0, 2, 0, 0, 0, 0, 0}, 3)}},
      {{"POSITION", writer.add<float>("VEC3", 5126, {0, 0, 0, 0, 0, 0, 0, 4, 0}, 3)}}};
  writer.json["meshes"][0]["weights"] = {0.5, 0};
  writer.json["nodes"] = json::parse(R"([{"mesh":0},{"mesh":0,"weights":[0,0.25]},{"mesh":0}])");
  writer.json["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = imported(writer, folder);
  expectNear(worldPositions(scene, 0), {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}});
  expectNear(worldPositions(scene, 1), {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
  EXPECT_EQ(scene.meshes.size(), 2u);  // nodes that stand alike share
  EXPECT_EQ(scene.nodes[2].mesh, scene.nodes[0].mesh);
  // The normal is (0, 0, 1) + 0.5 (2, 0, 0), normalized.
  EXPECT_NEAR(scene.meshes[0].primitives[0].mesh.normals[1].x, 0.70710678f, 1e-6f);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("do not move"), std::string::npos);
}

// Makes a triangle on two joints: vertex 0 on the first, 1 on the second, 2 half on each. Node 0 is the
// figure, 1 and 2 are the joints, 3 the mesh, whose own transform must not affect a skinned mesh.
GltfWriter skinned() {
  GltfWriter writer = oneTriangle();
  json& attributes = writer.primitive()["attributes"];
  attributes["JOINTS_0"] = writer.add<std::uint8_t>("VEC4", 5121, {0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 4);
  attributes["WEIGHTS_0"] =
      writer.add<std::uint8_t>("VEC4", 5121, {255, 0, 0, 0, 255, 0, 0, 0, 128, 128, 0, 0}, 4);
  writer.json["accessors"].back()["normalized"] = true;
  writer.json["nodes"] = json::parse(R"([{"name":"figure","children":[1,2,3],"translation":[0,0,1]},
      {"translation":[10,0,0]},{"translation":[0,20,0],"scale":[2,2,2]},
      {"name":"body","mesh":0,"skin":0,"translation":[7,7,7],"scale":[3,1,1]}])");
  writer.json["skins"] = json::parse(R"([{"joints":[1,2]}])");
  std::vector<float> inverse_bind(32, 0.0f);
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < 4; ++i) inverse_bind[16 * j + 5 * i] = 1.0f;
  inverse_bind[16 + 12] = -1.0f;  // the second joint was bound at x = 1
  writer.json["skins"][0]["inverseBindMatrices"] = writer.add<float>("MAT4", 5126, inverse_bind, 16);
  return writer;
}

const std::vector<glm::vec3> kSkinned = {{10, 0, 1},         // (0,0,0) + joint 0
                                         {0, 20, 1},         // ((1,0,0) - (1,0,0)) 2 + joint 1
                                         {4, 11.5f, 1.0f}};  // (0,1,0): mean of (10,1,1) and (-2,22,1)

TEST(Skins, PlaceVerticesByTheirJointsAndNotByTheirNode) {
  TemporaryFolder folder;
  GltfWriter writer = skinned();
  const Scene scene = imported(writer, folder);
  ASSERT_EQ(scene.nodes.at(3).name, "body");
  expectNear(worldPositions(scene, 3), kSkinned);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("node 3: its skin"), std::string::npos);
}

TEST(Skins, StandRightUnderFlatAndMirroredNodes) {
  TemporaryFolder folder;
  for (const char* scale : {"[0,0,0]", "[-1,1,1]"}) {
    GltfWriter writer = skinned();
    writer.json["nodes"][3]["scale"] = json::parse(scale);
    const Scene scene = imported(writer, folder);
    ASSERT_EQ(scene.nodes.size(), 5u) << scale;  // one of its own
    EXPECT_EQ(scene.nodes[3].mesh, -1);
    EXPECT_EQ(scene.nodes[4].name, "body");
    expectNear(worldPositions(scene, 4), kSkinned);
  }
}

TEST(Skins, MayHangOnTheirOwnNode) {
  TemporaryFolder folder;
  GltfWriter writer = skinned();
  writer.json["skins"][0]["joints"] = {3, 3};
  writer.json["skins"][0].erase("inverseBindMatrices");
  const Scene scene = imported(writer, folder);
  expectNear(worldPositions(scene, 3), {{7, 7, 8}, {10, 7, 8}, {7, 8, 8}});
}

TEST(Skins, ThatMakeNoSenseAreRefusedByName) {
  TemporaryFolder folder;
  const auto refused = [&](auto spoil, const char* words) {
    GltfWriter writer = skinned();
    spoil(writer);
    const std::string line = testing::refusal(writer, folder);
    EXPECT_NE(line.find(words), std::string::npos) << words << ": " << line;
  };
  refused([](GltfWriter& w) { w.json["skins"][0]["joints"] = {1}; }, "vertex 1 hangs on joint 1 of 1");
  refused(
      [](GltfWriter& w) {
        w.json["skins"][0]["joints"] = {1, 2, 2};
      },
      "skin 0: 2 inverse bind matrices for 3 joints");
  refused([](GltfWriter& w) { w.json["skins"][0]["inverseBindMatrices"] = 0; }, "inverseBindMatrices");
  refused([](GltfWriter& w) { w.primitive()["attributes"].erase("WEIGHTS_0"); },
          "WEIGHTS_0 has 0 elements, POSITION 3");
  refused(
      [](GltfWriter& w) {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        w.primitive()["attributes"]["WEIGHTS_0"] =
            w.add<float>("VEC4", 5126, {1, 0, 0, 0, nan, 0, 0, 0, 1, 0, 0, 0}, 4);
      },
      "vertex 1 has a joint weight of nan");
  refused([](GltfWriter& w) { w.json["nodes"][1]["children"] = {0}; }, "its own ancestor");
  refused(
      [](GltfWriter& w) {
        w.primitive()["targets"] = {{{"POSITION", w.add<float>("VEC3", 5126, {0, 0, 0}, 3)}}};
        w.json["meshes"][0]["weights"] = {1};
      },
      "morph target 0: POSITION has 1 elements, the mesh 3");
}

}  // namespace
}  // namespace lambent::baker
