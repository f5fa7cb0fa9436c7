// Tests what nodes do to meshes: poses by morph targets and skins, animations, and instances.
#include <limits>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using gltf::AnimationChannel;
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
