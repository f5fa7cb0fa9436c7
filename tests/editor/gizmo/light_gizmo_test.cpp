#include "editor/gizmo/light_gizmo.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "editor/gizmo/camera_control.hpp"
#include "views.hpp"

namespace lambent::editor {
namespace {

using Kind = scene::LocalLightComponent::Kind;
using testing::kViewport;
using testing::lookAt;

scene::LocalLightComponent lightOf(Kind kind) {
  scene::LocalLightComponent light;
  light.kind = kind;
  light.radius_m = 0.4f;
  light.range_m = 1.0f;
  light.strength = 2.0f;
  light.inner_cone_rad = 0.3f;
  light.outer_cone_rad = 0.6f;
  return light;
}

TEST(LightGizmo, ARadiusFollowsThePointer) {
  for (const bool perspective : {true, false}) {
    const spec::View view = lookAt({0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, perspective);
    const auto pixels = static_cast<float>(Projection(view, kViewport).pixelsPerMetre(glm::dvec3(0.0)));
    for (const Kind kind : {Kind::Sphere, Kind::Disc}) {
      LightGizmo gizmo;
      gizmo.setView(view, kViewport);
      gizmo.setLight(lightOf(kind), glm::scale(glm::mat4(1.0f), glm::vec3(3.0f)));  // its scale says nothing
      const auto grab = gizmo.handleScreenPoint(LightHandle::Radius);
      ASSERT_TRUE(grab && gizmo.press(*grab));
      EXPECT_NEAR(gizmo.drag(*grab + glm::vec2(0.3f * pixels, 0.0f)).radius_m, 0.7f, 2e-3f);
      EXPECT_EQ(gizmo.drag(*grab).radius_m, 0.4f);
      EXPECT_EQ(gizmo.drag(*grab - glm::vec2(0.4f * pixels, 0.0f)).radius_m > 0.01f, false)
          << "down to nothing";
      EXPECT_EQ(gizmo.cancel().radius_m, 0.4f);
    }
  }
}

TEST(LightGizmo, ConesFollowThePointerFromEverySideAndStayInOrder) {
  for (const glm::vec3 eye : {glm::vec3(4.0f, 0.0f, 0.0f), glm::vec3(0.0f, 0.0f, 5.0f),
                              glm::vec3(0.1f, 0.0f, -5.0f), glm::vec3(2.0f, 3.0f, -3.0f)}) {
    const Projection projection(lookAt(eye, {0.0f, 0.0f, 0.0f}, true), kViewport);
    LightGizmo gizmo;
    gizmo.setView(lookAt(eye, {0.0f, 0.0f, 0.0f}, true), kViewport);
    gizmo.setLight(lightOf(Kind::Spot), glm::mat4(1.0f));
    // Dragging to where the handle would be at another angle must give that angle.
    scene::LocalLightComponent other = lightOf(Kind::Spot);
    other.outer_cone_rad = 0.9f;
    const glm::vec2 grab = *gizmo.handleScreenPoint(LightHandle::OuterCone);
    LightGizmo wider = gizmo;
    wider.setLight(other, glm::mat4(1.0f));
    ASSERT_TRUE(gizmo.press(LightHandle::OuterCone, grab));
    const bool along_axis = std::abs(eye.x) < 0.2f;
    const glm::vec2 there = *wider.handleScreenPoint(LightHandle::OuterCone);
    if (along_axis)
      EXPECT_GT(gizmo.drag(grab + 0.5f * (there - grab)).outer_cone_rad, 0.61f);
    else
      EXPECT_NEAR(gizmo.drag(there).outer_cone_rad, 0.9f, 1e-3f) << eye.x << " " << eye.y << " " << eye.z;
    gizmo.release();
    gizmo.setLight(lightOf(Kind::Spot), glm::mat4(1.0f));
    ASSERT_TRUE(gizmo.press(LightHandle::OuterCone, grab));
    const scene::LocalLightComponent closed = gizmo.drag(glm::vec2(*projection.toScreen({0.0, 0.0, -0.3})));
    EXPECT_LE(closed.inner_cone_rad, closed.outer_cone_rad);
    EXPECT_LT(closed.outer_cone_rad, 0.3f);
  }
}

TEST(LightGizmo, StrengthDoublesByTheSameWayEachTime) {
  LightGizmo gizmo;
  gizmo.setView(lookAt({0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, 0.0f}, true), kViewport);
  gizmo.setLight(lightOf(Kind::Directional), glm::mat4(1.0f));
  const auto grab = gizmo.handleScreenPoint(LightHandle::Strength);
  ASSERT_TRUE(grab && gizmo.press(*grab));
  EXPECT_FLOAT_EQ(gizmo.drag(*grab - glm::vec2(0.0f, 80.0f)).strength, 8.0f);
  EXPECT_FLOAT_EQ(gizmo.drag(*grab + glm::vec2(0.0f, 40.0f)).strength, 1.0f);
  EXPECT_LE(gizmo.drag(*grab - glm::vec2(0.0f, 9000.0f)).strength, 1e9f) << "within the field's range";
  EXPECT_FALSE(gizmo.handleScreenPoint(LightHandle::Radius)) << "a directional light has none";
}

}  // namespace
}  // namespace lambent::editor
