// Compares materials that are changed while they are shown with scenes baked with them.
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/scene/materials.hpp"
#include "runtime/world/material_rebake.hpp"
#include "tests/stability/show.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

using testing::add;
using testing::named;
using testing::Show;

const spec::Light kSun = spec::SunLight{
    .azimuth_deg = 40.0f, .elevation_deg = 50.0f, .angle_deg = 10.0f, .radiance = glm::vec3(20.0f)};

struct Look {
  glm::vec3 color{1.0f};
  float roughness = 1.0f, metallic = 0.0f;
};

// Makes a ball that shadows the floor on which it lies.
Show show(const Look& look, int bounces) {
  assets::Scene scene = named("ball on a floor");
  add(scene, "floor", assets::box({-3.0f, -1.2f, -3.0f}, {3.0f, -1.0f, 3.0f}, 0.5f), glm::vec3(0.7f),
      glm::vec3(0.0f), /*movable=*/false);
  add(scene, "ball", assets::sphere(1.0f, 10), look.color, glm::vec3(0.0f), /*movable=*/false);
  scene.materials[1].roughness = look.roughness;
  scene.materials[1].metallic = look.metallic;
  if (look.roughness < 1.0f) scene.materials[1].specular = 1.0f;
  return Show(scene, {kSun}, /*light_probes=*/0, bounces);
}

glm::vec3 ballOf(Show& show) {
  return show.patch({1.0f, 1.0f, 6.0f}, {0.3f, 0.4f, 0.8f});
}
glm::vec3 floorOf(Show& show) {
  return show.patch({1.0f, 3.0f, 6.0f}, {-0.3f, -1.0f, 1.2f});
}

void change(Show& show, const Look& look) {
  auto& registry = show.world.registry();
  auto& material = registry.edit<scene::MaterialComponent>(show.world.instance(0).materials[1]);
  material.base_color = look.color;
  material.roughness = look.roughness;
  material.metallic = look.metallic;
}

std::vector<frame::RebakeReason> reasons(const Show& show) {
  const bundle::Description& description = show.world.description(0);
  for (std::size_t draw = 0; draw < description.draws.size(); ++draw)
    if (show.world.residency().draws()[draw].material == 1)
      return frame::needsRebake(show.world.material(draw), show.world.bakedMaterial(draw),
                                frame::materialUse(description, 1));
  ADD_FAILURE() << "no draw of the ball";
  return {};
}

using LiveMaterials = testing::GpuTest;

TEST_F(LiveMaterials, ARoughnessOnDirectLightIsThatOfARebake) {
  const Look dull{.color = glm::vec3(0.9f, 0.7f, 0.4f), .roughness = 0.7f, .metallic = 1.0f};
  const Look shiny{.color = glm::vec3(0.9f, 0.7f, 0.4f), .roughness = 0.3f, .metallic = 1.0f};
  glm::vec3 before, ball;
  {
    Show live = show(dull, /*bounces=*/0);
    before = ballOf(live);
    change(live, shiny);
    ball = ballOf(live);
    EXPECT_TRUE(reasons(live).empty());
  }
  Show baked = show(shiny, /*bounces=*/0);
  const glm::vec3 expected = ballOf(baked);
  EXPECT_GT(glm::distance(before, expected), 0.05f * glm::length(expected));
  // Each of the two is coded for what its own lobes show.
  EXPECT_LT(glm::distance(ball, expected), 0.02f * glm::length(expected));
}

TEST_F(LiveMaterials, BouncedLightKeepsItsColorAndSaysSo) {
  const Look red{.color = {0.9f, 0.05f, 0.05f}}, blue{.color = {0.05f, 0.05f, 0.9f}};
  Show live = show(red, /*bounces=*/2);
  const glm::vec3 floor = floorOf(live);
  change(live, blue);
  const glm::vec3 after = floorOf(live);
  EXPECT_EQ(after, floor) << "what lies on the floor was baked";
  const auto found = reasons(live);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].field, "base_color");
  EXPECT_TRUE(found[0].shows);
}

}  // namespace
}  // namespace lambent
