#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "editor/document/history.hpp"
#include "editor/session/field_numbers.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/session/viewing.hpp"
#include "tests/editor/document/small_world.hpp"
#include "tests/editor/program/windowless.hpp"

namespace lambent::editor {
namespace {

TEST(PictureScale, IsCoarseOnlyWhileSlowPicturesMove) {
  PictureScale scale;
  scale.drawn(/*moves=*/true);
  EXPECT_EQ(scale.now(), 1.0f) << "nothing is known to be slow";
  scale.wholeTook(320.0);
  scale.drawn(/*moves=*/true);
  EXPECT_NEAR(scale.now(), 0.5f, 1e-6f) << "a quarter of the pixels in a quarter of the time";
  EXPECT_TRUE(scale.settle());
  EXPECT_EQ(scale.now(), 1.0f);
  EXPECT_FALSE(scale.settle());
}

TEST(PictureScale, StaysWholeWherePicturesAreFast) {
  PictureScale scale;
  scale.whole = 2.0f;
  scale.wholeTook(320.0);
  scale.wholeTook(100.0);
  scale.drawn(/*moves=*/true);
  EXPECT_FALSE(scale.coarse());
  EXPECT_EQ(scale.now(), 2.0f);
}

TEST(PictureScale, LeavesAQuarterAlongEachEdgeAtLeast) {
  PictureScale scale;
  scale.wholeTook(60000.0);
  scale.drawn(/*moves=*/true);
  EXPECT_EQ(scale.now(), 0.25f);
}

// Tests the units of lights against closed forms, and the lights that a user adds.

using Kind = scene::LocalLightComponent::Kind;
constexpr double kPi = std::numbers::pi;

scene::LocalLightComponent lightOf(Kind kind) {
  scene::LocalLightComponent light;
  light.kind = kind;
  light.radius_m = 0.5f;
  return light;
}

TEST(LightUnits, AreThoseOfUniformLamps) {
  EXPECT_NEAR(unitOf(lightOf(Kind::Point), "lm").factor, 4.0 * kPi, 1e-12);
  // A sphere of radiance 1 sends pi W/m² from each part of its surface, and is seen as a disc.
  EXPECT_NEAR(unitOf(lightOf(Kind::Sphere), "lm").factor, kPi * 4.0 * kPi * 0.25, 1e-12);
  EXPECT_NEAR(unitOf(lightOf(Kind::Sphere), "cd").factor, kPi * 0.25, 1e-12);
  EXPECT_NEAR(unitOf(lightOf(Kind::Disc), "lm").factor, kPi * kPi * 0.25, 1e-12);
  EXPECT_EQ(unitOf(lightOf(Kind::Directional), "lm").name, "lx") << "it has no end, and so no flux";
}

TEST(LightUnits, OfASpotAreTheIntegralOfItsFalloff) {
  scene::LocalLightComponent spot = lightOf(Kind::Spot);
  spot.inner_cone_rad = 0.3f, spot.outer_cone_rad = 0.9f;
  const double inner = std::cos(0.3), outer = std::cos(0.9);
  double flux = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = outer + (i + 0.5) / kSteps * (1.0 - outer);
    const double falloff = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
    flux += 2.0 * kPi * falloff * falloff * (1.0 - outer) / kSteps;
  }
  EXPECT_NEAR(unitOf(spot, "lm").factor, flux, 1e-6);
  spot.inner_cone_rad = spot.outer_cone_rad = std::numbers::pi_v<float> / 2.0f;
  EXPECT_NEAR(unitOf(spot, "lm").factor, 2.0 * kPi, 1e-6) << "half of all directions";
}

class NewLights : public testing::Windowless {
 protected:
  void SetUp() override {
    Windowless::SetUp();
    session->viewing.goal.target_ws = {0.0f, 0.0f, 0.0f};
    session->viewing.goal.distance_m = 8.0f;
    session->viewing.surface_ahead = [] { return std::optional(glm::vec3(0.0f, 1.0f, 0.0f)); };
    session->picture.exposure_ev = -3.0f;
  }
  const scene::LocalLightComponent& made(const char* command) {
    answer(command);
    const ecs::Entity entity = session->selection.primaryEntity(session->document);
    session->update(0.0);
    return session->document.registry().get<scene::LocalLightComponent>(entity);
  }
  glm::mat4 place() const {
    return worldFromNode(session->document.registry(), session->selection.primaryEntity(session->document));
  }
};

// All kinds light a white surface where the camera looks to half of what the exposure shows as white.
TEST_F(NewLights, LightWhatTheCameraSeesByHalfOfWhite) {
  const double white = kPi * std::exp2(3.0);
  for (const char* command : {"create-point", "create-spot", "create-sphere", "create-disc"}) {
    const scene::LocalLightComponent light = made(command);
    const double distance = glm::length(glm::vec3(place()[3]) - glm::vec3(0.0f, 1.0f, 0.0f));
    const double intensity = double{light.strength} * unitOf(light, "cd").factor;
    EXPECT_NEAR(intensity / (distance * distance) / white, 0.5, 0.06) << command;  // two digits each
  }
  EXPECT_NEAR(double{made("create-directional").strength} / white, 0.5, 0.03);
}

TEST_F(NewLights, StandOnTheWayToTheCameraAndShineFromThere) {
  const glm::vec3 surface(0.0f, 1.0f, 0.0f), eye = session->viewing.goal.eye();
  for (const char* command : {"create-spot", "create-disc"}) {
    made(command);
    const glm::vec3 at(place()[3]), back = glm::normalize(glm::vec3(place()[2]));
    EXPECT_GT(glm::dot(at - surface, eye - surface), 0.0f);
    EXPECT_NEAR(glm::length(glm::cross(at - surface, eye - surface)), 0.0f, 1e-4f) << command;
    EXPECT_NEAR(glm::dot(back, glm::normalize(at - surface)), 1.0f, 1e-4f) << command;
  }
  made("create-directional");
  EXPECT_LT(-place()[2].y, -0.5f) << "it comes from above";
  EXPECT_GT(glm::dot(glm::vec3(place()[2]), glm::normalize(eye)), 0.5f) << "and from behind the camera";
}

TEST_F(NewLights, HaveTheFieldsOfTheirKindAlone) {
  const auto used = [&](const char* field) {
    return isUsed(session->document.registry(), session->selection.primaryEntity(session->document),
                  **scene::findField("Light", field));
  };
  made("create-sphere");
  EXPECT_TRUE(used("radius") && used("strength"));
  EXPECT_FALSE(used("range") || used("inner_cone") || used("outer_cone"));
  made("create-spot");
  EXPECT_TRUE(used("range") && used("inner_cone") && used("outer_cone"));
  EXPECT_FALSE(used("radius"));
  made("create-directional");
  EXPECT_FALSE(used("radius") || used("range") || used("outer_cone"));
}

glm::mat4 placedAt(float x, float y, float z) {
  return glm::translate(glm::mat4(1.0f), glm::vec3(x, y, z));
}

class NodeEdits : public ::testing::Test {
 protected:
  baker::SceneEdits edits() const {
    baker::SceneEdits found;
    addNodeEdits(world.registry, world.description, world.instance, found);
    return found;
  }
  // Returns the node's matrix in the edited scene.
  glm::mat4 baked(const baker::SceneEdits& with, std::string_view name) const {
    std::vector<gltf::Node> nodes = world.description.nodes;
    for (const auto& edit : with.nodes) nodes[edit.index].parent_from_node = edit.parent_from_node;
    const std::vector<glm::mat4> matrices = gltf::worldTransforms(nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i].name == name) return matrices[i];
    return {};
  }

  testing::SmallWorld world;
  Document document{world.registry, 1};
  History history{document};
};

TEST_F(NodeEdits, ANodeThatIsHungElsewhereIsBakedWhereItStands) {
  EXPECT_TRUE(edits().empty());
  const ecs::Entity lamp = world.node("lamp"), table = world.node("table"), camera = world.node("camera");
  const glm::mat4 before = worldFromNode(world.registry, lamp);
  ASSERT_TRUE(history.reparent(lamp, camera, /*keep_place=*/true));
  EXPECT_TRUE(edits().empty()) << "it stands where it stood";
  // It follows its new parent, and not the old one.
  ASSERT_TRUE(history.setField(camera, "Transform", "translation", glm::vec3(3.0f, 1.0f, 5.0f)));
  ASSERT_TRUE(history.setField(table, "Transform", "translation", glm::vec3(0.0f, 0.0f, 7.0f)));
  const glm::mat4 now = worldFromNode(world.registry, lamp);
  EXPECT_TRUE(samePlace(now, placedAt(3.0f, 0.0f, 0.0f) * before));
  EXPECT_TRUE(samePlace(baked(edits(), "lamp"), now));
  EXPECT_TRUE(samePlace(baked(edits(), "table"), worldFromNode(world.registry, table)));
  history.undo(), history.undo(), history.undo();
  EXPECT_TRUE(edits().empty());
}

TEST(SamePlace, ForgivesRoundingButNoMove) {
  const glm::mat4 far = placedAt(1000.0f, 0.0f, -3.0f), small = glm::scale(glm::mat4(1.0f), glm::vec3(1e-3f));
  EXPECT_TRUE(samePlace(placedAt(1000.003f, 0.0f, -3.0f), far));
  EXPECT_FALSE(samePlace(placedAt(1000.02f, 0.0f, -3.0f), far));
  EXPECT_FALSE(samePlace(placedAt(0.0f, 2e-5f, 0.0f), placedAt(0.0f, 0.0f, 0.0f)));
  // A thousandth of the size of a small thing counts as a change.
  EXPECT_FALSE(samePlace(glm::scale(small, glm::vec3(1.001f)), small));
  EXPECT_TRUE(samePlace(glm::scale(small, glm::vec3(1.000001f)), small));
}

}  // namespace
}  // namespace lambent::editor
