// Tests what is done for scenes as a whole: those that are far from the origin of their file, as surveys have
// them, and those with a dome that keeps light from outside away.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using testing::GltfWriter;
using testing::imported;
using testing::oneTriangle;
using testing::TemporaryFolder;

constexpr double kEast = 5412345.125, kUp = 310.25, kSouth = -487654.5;
const json kThere = {kEast, kUp, kSouth}, kBack = {-kEast, -kUp, -kSouth};

// Returns the corners of the first mesh that is drawn, in the world of the file.
std::vector<glm::dvec3> corners(const Scene& scene) {
  const auto world = gltf::worldTransforms(scene.nodes);
  std::vector<glm::dvec3> found;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (scene.nodes[n].mesh >= 0 && found.empty())
      for (const glm::vec3& p :
           scene.meshes[static_cast<std::size_t>(scene.nodes[n].mesh)].primitives[0].mesh.positions)
        found.push_back(scene.origin + glm::dvec3(world[n] * glm::vec4(p, 1.0f)));
  return found;
}

void expectTriangleThere(const Scene& scene) {
  const std::vector<glm::dvec3> found = corners(scene);
  ASSERT_EQ(found.size(), 3u);
  const glm::dvec3 there(kEast, kUp, kSouth);
  // Floats within a few metres of the origin are 5e-7 m apart.
  EXPECT_LT(glm::distance(found[0], there), 1e-6);
  EXPECT_LT(glm::distance(found[1], there + glm::dvec3(1, 0, 0)), 1e-6);
  EXPECT_LT(glm::distance(found[2], there + glm::dvec3(0, 1, 0)), 1e-6);
}

TEST(NearOrigin, KeepsShapesWhateverNodeCarriesTheDistance) {
  TemporaryFolder folder;
  {
    SCOPED_TRACE("root");
    GltfWriter writer = oneTriangle();
    writer.json["nodes"][0]["translation"] = kThere;
    expectTriangleThere(imported(writer, folder));
  }
  {
    SCOPED_TRACE("matrix");
    GltfWriter writer = oneTriangle();
    writer.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, kEast, kUp, kSouth, 1};
    expectTriangleThere(imported(writer, folder));
  }
  {
    SCOPED_TRACE("below a node that turns +Z up and scales centimetres to metres");
    GltfWriter writer = oneTriangle();
    writer.json["nodes"] = {
        {{"children", {1}}, {"matrix", {0.01, 0, 0, 0, 0, 0, -0.01, 0, 0, 0.01, 0, 0, 0, 0, 0, 1}}},
        {{"mesh", 0},
         {"matrix", {100, 0, 0, 0, 0, 0, 100, 0, 0, -100, 0, 0, 100 * kEast, -100 * kSouth, 100 * kUp, 1}}}};
    expectTriangleThere(imported(writer, folder));
  }
  {
    SCOPED_TRACE("an instance");
    GltfWriter writer = oneTriangle();
    writer.json["nodes"][0]["translation"] = {kEast - 5e6, kUp, kSouth};
    writer.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
        writer.add<float>("VEC3", 5126, {5e6f, 0, 0}, 3);
    expectTriangleThere(imported(writer, folder));
  }
  {
    SCOPED_TRACE("a joint of a mesh whose own node is elsewhere");
    GltfWriter writer = oneTriangle();
    writer.primitive()["attributes"]["JOINTS_0"] =
        writer.add<std::uint8_t>("VEC4", 5121, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 4);
    writer.primitive()["attributes"]["WEIGHTS_0"] =
        writer.add<float>("VEC4", 5126, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
    writer.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"translation", kThere}}};
    writer.json["scenes"][0]["nodes"] = {0, 1};
    writer.json["skins"] = {{{"joints", {1}}}};
    expectTriangleThere(imported(writer, folder));
  }
  {
    SCOPED_TRACE("an animated node");
    GltfWriter writer = oneTriangle();
    writer.json["nodes"][0]["translation"] = kThere;
    const int times = writer.add<float>("SCALAR", 5126, {0, 1}, 1);
    const int places = writer.add<float>("VEC3", 5126, {5e6f, 0, 0, 5.5e6f, 2, 0}, 3);
    writer.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", places}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    const Scene scene = imported(writer, folder);
    expectTriangleThere(scene);
    const auto& values = scene.animations.at(0).channels.at(0).values;
    EXPECT_EQ(scene.origin.x + double{values[0]}, 5e6);
    EXPECT_EQ(scene.origin.y + double{values[4]}, 2.0);
    EXPECT_EQ(scene.nodes[0].trs->matrix(), scene.nodes[0].parent_from_node);
  }
}

TEST(NearOrigin, MovesFarVerticesIntoTheirNodes) {
  TemporaryFolder folder;
  GltfWriter writer;  // floats there are 1/32 m apart
  writer.addPositions({500000, 2, -300000, 500001, 2, -300000, 500000, 3, -300000});
  writer.json["nodes"][0]["camera"] = 0;
  writer.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  const Scene scene = imported(writer, folder);
  EXPECT_EQ(corners(scene),
            (std::vector<glm::dvec3>{{500000, 2, -300000}, {500001, 2, -300000}, {500000, 3, -300000}}));
  for (const glm::vec3& p : scene.meshes[0].primitives[0].mesh.positions) EXPECT_LE(glm::length(p), 2.0f);
  EXPECT_EQ(scene.origin + glm::dvec3(gltf::worldTransforms(scene.nodes)[0][3]), glm::dvec3(0.0))
      << "the camera stays";
}

TEST(NearOrigin, DistancesThatCancelOutLeaveTheSceneAtTheOrigin) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["nodes"] = {{{"children", {1}}, {"translation", kThere}},
                          {{"mesh", 0}, {"translation", kBack}, {"rotation", {0, 1, 0, 0}}}};
  const Scene scene = imported(writer, folder);
  EXPECT_EQ(scene.origin, glm::dvec3(0.0));
  for (const gltf::Node& node : scene.nodes)
    EXPECT_EQ(node.parent_from_node[3], glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
}

TEST(NearOrigin, LeavesScenesThatAreNearAsTheyAre) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["nodes"] = {{{"children", {1}}, {"translation", {3.1, 0, 0}}},
                          {{"mesh", 0}, {"translation", {0.1, -2.3, 0}}}};
  const Scene scene = imported(writer, folder);
  EXPECT_EQ(scene.origin, glm::dvec3(0.0));
  ASSERT_EQ(scene.nodes.size(), 2u);
  EXPECT_EQ(scene.nodes[0].parent_from_node[3], glm::vec4(3.1f, 0.0f, 0.0f, 1.0f));
  EXPECT_EQ(scene.nodes[1].parent_from_node[3], glm::vec4(0.1f, -2.3f, 0.0f, 1.0f));
}

TEST(NearOrigin, DistancesWithoutDigitsLeftAreRefused) {
  TemporaryFolder folder;
  GltfWriter far = oneTriangle();
  far.json["nodes"][0]["translation"] = {0, 1e30, 0};
  EXPECT_NE(refusal(far, folder).find("reaches 1e+30 m from the origin"), std::string::npos);
  GltfWriter cancels = oneTriangle();
  cancels.json["nodes"] = {{{"children", {1}}, {"translation", {0, 1e30, 0}}},
                           {{"mesh", 0}, {"translation", {0, -1e30, 0}}}};
  EXPECT_NE(refusal(cancels, folder).find("reaches 1e+30 m from the origin"), std::string::npos);
}

// Adds a node of a mesh without indices.
json& addBody(GltfWriter& writer, const std::vector<float>& corners) {
  const int positions = writer.add<float>("VEC3", 5126, corners, 3);
  writer.json["meshes"].push_back(
      {{"primitives", json::array({{{"attributes", {{"POSITION", positions}}}}})}});
  writer.json["nodes"].push_back({{"mesh", writer.json["meshes"].size() - 1}});
  writer.json["scenes"][0]["nodes"].push_back(writer.json["nodes"].size() - 1);
  return writer.json["nodes"].back();
}

// Returns triangles of a sphere of radius 10 from one angle from +Y to another.
std::vector<float> sphere(double from, double to) {
  std::vector<float> corners;
  const auto corner = [&](int i, int j) {
    const double theta = from + (to - from) * i / 12, phi = 2.0 * std::numbers::pi * j / 24;
    for (const double x : {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)})
      corners.push_back(static_cast<float>(10.0 * x));
  };
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 24; ++j) {
      corner(i, j), corner(i + 1, j), corner(i, j + 1);
      corner(i, j + 1), corner(i + 1, j), corner(i + 1, j + 1);
    }
  return corners;
}

// Returns a closed room of 20 m.
std::vector<float> room() {
  std::vector<float> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-10.0f, 10.0f})
      for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {-1, 1}, {-1, 1}, {1, -1}, {1, 1}}) {
        float p[3];
        p[axis] = side, p[(axis + 1) % 3] = 10.0f * static_cast<float>(u),
        p[(axis + 2) % 3] = 10.0f * static_cast<float>(v);
        corners.insert(corners.end(), p, p + 3);
      }
  return corners;
}

std::ptrdiff_t warningsWith(const std::vector<float>& corners, const json& more = json::object(),
                            const char* alpha_mode = "OPAQUE") {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  addBody(writer, corners).update(more);
  writer.json["materials"] = {{{"alphaMode", alpha_mode}}};
  writer.json["meshes"].back()["primitives"][0]["material"] = 0;
  const Scene scene = imported(writer, folder);
  return std::ranges::count_if(scene.warnings, [](const std::string& warning) {
    return warning.starts_with("node 1") &&
           warning.find("keeps all light from outside away") != std::string::npos;
  });
}

constexpr double kHalfTurn = std::numbers::pi;

TEST(SkyDome, ThatIsClosedAboveTheSceneIsSaidByName) {
  EXPECT_EQ(warningsWith(sphere(0.0, kHalfTurn)), 1);
  EXPECT_EQ(warningsWith(sphere(0.0, 0.5 * kHalfTurn)), 1);
  EXPECT_EQ(warningsWith(sphere(0.0, kHalfTurn), {{"scale", {20, 5, 20}}}), 1);
  EXPECT_EQ(warningsWith(room(), {{"name", "SkyBox"}}), 1);
}

TEST(SkyDome, IsNoBowlNorRoomNorPaneNorOpening) {
  EXPECT_EQ(warningsWith(sphere(0.5 * kHalfTurn, kHalfTurn)), 0);
  EXPECT_EQ(warningsWith(sphere(0.1 * kHalfTurn, kHalfTurn)), 0);
  EXPECT_EQ(warningsWith(room()), 0);
  EXPECT_EQ(warningsWith(sphere(0.0, kHalfTurn), json::object(), "BLEND"), 0);
}

}  // namespace
}  // namespace lambent::baker
