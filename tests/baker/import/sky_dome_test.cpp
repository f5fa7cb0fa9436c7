// Tests the warning about a dome that keeps light from outside away.
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
