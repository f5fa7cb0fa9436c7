// Compares the light of the group's own lights with closed forms: Lambert's formula for polygons, closed
// boxes, the inverse square law.
#include "baker/trace/emitters.hpp"

#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::sceneOf;
using testing::transformed;
using testing::Transport;

// Makes a floor under a square panel that emits downwards.
Scene panelScene(float height, float width, float floor_width = 4.0f) {
  Scene scene = sceneOf({grid({0, 0, 0}, floor_width, 8), flipped(grid({0, height, 0}, width, 2))});
  scene.materials[0].base_color = {0.0f, 0.0f, 0.0f, 1.0f};
  testing::ownMaterial(scene, 1).emissive = {2.0f, 3.0f, 4.0f};
  return scene;
}

TEST(GroupLights, PanelAboveAFloorMatchesLambertsFormula) {
  for (const float height : {0.05f, 0.5f, 3.0f}) {
    const Transport t(panelScene(height, 1.0f));
    ASSERT_EQ(t.lights.size(), 1u);
    EXPECT_EQ(t.lights[0].color, glm::vec3(2.0f, 3.0f, 4.0f));
    const auto field = t.direct(2, 1024);
    ASSERT_EQ(field.columns, 5u);
    ASSERT_EQ(field.channels, 1u);  // the column is at unit strength
    const double h = double{height};
    const std::vector<glm::dvec3> corners = {{-0.5, h, -0.5}, {0.5, h, -0.5}, {0.5, h, 0.5}, {-0.5, h, 0.5}};
    double error = 0.0, energy = 0.0;
    for (std::size_t s = 0; s < t.samples.size(); ++s) {
      const glm::vec3 p = t.samples.positions[s];
      if (p.y != 0.0f) continue;
      const double exact = testing::formFactor(corners, p, {0, 1, 0});
      EXPECT_NEAR(field.at(s)[4], exact, 0.02) << height << " at " << p.x << ", " << p.z;
      error += std::pow(double{field.at(s)[4]} - exact, 2), energy += exact * exact;
    }
    // Just under the panel's edge, 5 cm away, 256 points and 1024 rays must resolve the edge of the light.
    EXPECT_LT(std::sqrt(error / energy), height < 0.1f ? 0.015 : 0.005) << height;
  }
}

TEST(GroupLights, ClosedEmittingBoxShinesWithTheGeometricSeries) {
  Scene scene = sceneOf({flipped(box({0, 0, 0}, {2, 1, 3}, 4))});
  scene.materials[0].base_color = glm::vec4(glm::vec3(0.5f), 1.0f);
  scene.materials[0].emissive = glm::vec3(1.0f);
  const Transport t(scene);
  const auto baked = t.bake(2, 1024, 20);
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    // E/pi from all walls is e / (1 - albedo), direct and in total. The box has corners, where sampling
    // emitters and rays are combined.
    EXPECT_NEAR(baked.direct.field.at(s)[4], 1.0f, 0.03f);
    EXPECT_NEAR(baked.direct.field.at(s)[4] + baked.bounced.field.at(s)[4], 2.0f, 0.03f);
  }
}

TEST(GroupLights, SingleSidedPanelShinesToItsFrontOnly) {
  Scene scene = panelScene(1.0f, 1.0f);
  scene.meshes[1].primitives[0].mesh = flipped(scene.meshes[1].primitives[0].mesh);
  const auto back = Transport(scene).direct(2, 256);
  for (std::size_t s = 0; s < 81; ++s) EXPECT_EQ(back.at(s)[4], 0.0f);
  scene.materials[1].double_sided = true;
  const Transport both(scene);
  EXPECT_GT(both.direct(2, 256).at(both.sampleAt({0, 0, 0}))[4], 0.1f);
}

Scene underLight(gltf::Light light, const glm::mat4& place) {
  Scene scene = sceneOf({grid({0, 0, 0}, 4.0f, 8)});
  testing::addLight(scene, light, place);
  return scene;
}

// Makes a node that looks down from `position`.
glm::mat4 lookingDown(glm::vec3 position) {
  return glm::rotate(glm::translate(glm::mat4(1.0f), position), glm::radians(-90.0f), {1, 0, 0});
}

TEST(GroupLights, PointLightFallsOffWithTheSquareAndTheCosine) {
  const glm::vec3 at(0.3f, 2.0f, -0.4f);
  gltf::Light light;
  light.intensity = 7.0f, light.color = {1.0f, 0.5f, 0.25f};
  const Transport t(underLight(light, glm::translate(glm::mat4(1.0f), at)));
  ASSERT_EQ(t.lights.size(), 1u);
  EXPECT_EQ(t.lights[0].color, glm::vec3(7.0f, 3.5f, 1.75f));
  const auto field = t.direct(2, 128);
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    const glm::vec3 offset = at - t.samples.positions[s];
    const float d2 = glm::dot(offset, offset);
    const float expected = offset.y / std::sqrt(d2) / d2 / static_cast<float>(std::numbers::pi);
    EXPECT_NEAR(field.at(s)[4], expected, 0.02f * expected);  // origins stand 3 % into the faces
  }
}

TEST(GroupLights, PointLightIsShadowed) {
  Scene scene = underLight({}, glm::translate(glm::mat4(1.0f), {0, 2, 0}));
  scene.meshes.push_back({"", {{flipped(grid({0, 1, 0}, 1.0f, 1)), 0}}});
  testing::addNode(scene).mesh = 1;
  const Transport t(scene);
  const auto field = t.direct(2, 128);
  EXPECT_EQ(field.at(t.sampleAt({0.5f, 0, 0.5f}))[4], 0.0f);  // shadow reaches out to 1 m
  EXPECT_GT(field.at(t.sampleAt({2.0f, 0, 2.0f}))[4], 0.0f);
}

TEST(GroupLights, SpotHasItsCone) {
  gltf::Light spot;
  spot.type = gltf::Light::Type::Spot;
  spot.inner_cone_rad = glm::radians(20.0f), spot.outer_cone_rad = glm::radians(30.0f);
  const Transport t(underLight(spot, lookingDown({0, 2, 0})));
  const auto field = t.direct(2, 128);
  EXPECT_NEAR(field.at(t.sampleAt({0, 0, 0}))[4], 1.0 / 4.0 / std::numbers::pi, 2e-3);
  EXPECT_EQ(field.at(t.sampleAt({1.5f, 0, 0}))[4], 0.0f);  // 37 degrees off its axis
}

TEST(GroupLights, DirectionalLightsHaveNoColumn) {
  gltf::Light sun;
  sun.type = gltf::Light::Type::Directional;
  const Scene scene = underLight(sun, lookingDown({0, 5, 0}));
  EXPECT_TRUE(findGroupLights(scene, findRigidGroups(scene).at(0)).empty());
}

TEST(GroupLights, RangeEndsALight) {
  gltf::Light light;
  light.range_m = 4.0f;
  EXPECT_NEAR(punctualIrradiance(light, {0, -1, 0}, {0, -2, 0}), 0.25f * (1.0f - 0.0625f), 1e-6f);
  EXPECT_EQ(punctualIrradiance(light, {0, -1, 0}, {0, -4.5f, 0}), 0.0f);
  EXPECT_EQ(punctualIrradiance(light, {0, -1, 0}, {0, 0, 0}), 0.0f);
}

}  // namespace
}  // namespace lambent::baker
