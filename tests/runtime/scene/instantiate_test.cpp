#include "runtime/scene/instantiate.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/scene/transforms.hpp"
#include "tests/runtime/scene/values.hpp"

namespace lambent::scene {
namespace {

using testing::kRounding;
using testing::kUp;

glm::mat4 moved(glm::vec3 by) {
  return glm::translate(glm::mat4(1.0f), by);
}
glm::mat4 turned(float degrees, glm::vec3 axis = kUp) {
  return glm::rotate(glm::mat4(1.0f), glm::radians(degrees), axis);
}
glm::mat4 scaled(glm::vec3 by) {
  return glm::scale(glm::mat4(1.0f), by);
}

std::int32_t addNode(bundle::Description& d, std::string name, std::int32_t parent, const glm::mat4& matrix) {
  const auto index = static_cast<std::int32_t>(d.nodes.size());
  gltf::Node& node = d.nodes.emplace_back();
  node.name = std::move(name);
  node.parent = parent;
  node.parent_from_node = matrix;
  if (parent < 0) {
    d.roots.push_back(index);
  } else {
    d.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
  }
  return index;
}

void addGroup(bundle::Description& d, std::int32_t node, glm::vec3 translation, glm::quat rotation) {
  bundle::Group group;
  group.name = node < 0 ? "scene" : d.nodes[static_cast<std::size_t>(node)].name;
  group.node = node;
  group.rest_translation = translation;
  group.rest_rotation = rotation;
  group.bounds_min = glm::vec3(-1.0f);
  group.bounds_max = glm::vec3(1.0f);
  d.groups.push_back(group);
}

// Makes a hall with two chairs of one mesh, and a mirrored, stretched top that moves: a group of its own.
struct Hall {
  Hall() {
    hall = addNode(d, "hall", -1, glm::mat4(1.0f));
    chair_a = addNode(d, "chair", hall, moved({2.0f, 0.0f, 0.0f}));
    chair_b = addNode(d, "chair", hall, moved({4.0f, 0.0f, 0.0f}));
    top = addNode(d, "top", hall, moved({0.0f, 3.0f, 0.0f}) * turned(40.0f) * scaled({-1.0f, 2.0f, 0.5f}));
    eye = addNode(d, "eye", -1, moved({0.0f, 1.0f, 9.0f}));
    d.nodes[static_cast<std::size_t>(eye)].camera = 0;
    d.cameras.push_back({.name = "front", .yfov_rad = 0.5f});
    bundle::Primitive seat, legs;
    seat.material = 1;
    seat.bounds_min = glm::vec3(-0.5f);
    seat.bounds_max = glm::vec3(0.5f);
    legs.bounds_min = glm::vec3(-0.5f, -1.0f, -0.5f);
    legs.bounds_max = glm::vec3(0.5f, -0.5f, 0.5f);
    d.meshes.push_back({.name = "chair", .primitives = {seat, legs}});
    d.materials.resize(2);
    addGroup(d, -1, glm::vec3(0.0f), glm::quat(1.0f, 0.0f, 0.0f, 0.0f));
    // This is one of the possible decompositions of a mirrored matrix; the runtime takes the baker's.
    addGroup(d, top, {0.0f, 3.0f, 0.0f}, glm::angleAxis(glm::radians(220.0f), kUp));
    for (const std::int32_t node : {chair_a, chair_b}) {
      d.draws.push_back({.node = static_cast<std::uint32_t>(node), .mesh = 0, .primitive = 0, .group = 0});
      d.draws.push_back({.node = static_cast<std::uint32_t>(node), .mesh = 0, .primitive = 1, .group = 0});
    }
    for (const bool back : {false, true}) {
      d.draws.push_back(
          {.node = static_cast<std::uint32_t>(top), .mesh = 0, .primitive = 0, .group = 1, .back = back});
    }
  }

  bundle::Description d;
  std::int32_t hall = 0, chair_a = 0, chair_b = 0, top = 0, eye = 0;
};

SceneInstance instance(ecs::Registry& registry, const bundle::Description& d, std::uint32_t number = 0) {
  auto made = instantiate(registry, d, {.bundle_index = 3, .bundle_id = "hall.lmb.glb", .instance = number});
  EXPECT_TRUE(made) << made.error().line();
  return made.value_or(SceneInstance{});
}

ecs::Entity nodeOf(const SceneInstance& scene, std::int32_t node) {
  return scene.nodes[static_cast<std::size_t>(node)];
}

TEST(Instantiate, EntitiesSayWhatTheDescriptionSays) {
  const Hall hall;
  ecs::Registry registry;
  const SceneInstance scene = instance(registry, hall.d);
  EXPECT_EQ(registry.entities().size(), 1 + 5 + 2 + 6 + 2u);
  const auto world = gltf::worldTransforms(hall.d.nodes);
  for (std::size_t i = 0; i < world.size(); ++i) {
    const glm::mat4& found = registry.get<WorldTransform>(scene.nodes[i]).world_from_node;
    for (int j = 0; j < 4; ++j) EXPECT_LT(glm::distance(found[j], world[i][j]), kRounding) << "node " << i;
  }
  const DrawItem& legs = registry.get<DrawItem>(scene.draws[3]);
  EXPECT_EQ(legs.bundle, 3u);
  EXPECT_EQ(legs.primitive, 1u);
  EXPECT_FALSE(legs.back);
  EXPECT_TRUE(registry.get<DrawItem>(scene.draws[5]).back);
  EXPECT_EQ(legs.material, -1);
  EXPECT_EQ(legs.node, nodeOf(scene, hall.chair_b));
  EXPECT_EQ(legs.group, scene.groups[0]);
  EXPECT_EQ(registry.get<CameraComponent>(nodeOf(scene, hall.eye)).yfov_rad, 0.5f);
  EXPECT_EQ(registry.get<Name>(nodeOf(scene, hall.top)).value, "top");
  EXPECT_LT(registry.get<Transform>(nodeOf(scene, hall.top)).scale.x, 0.0f) << "a mirror stays one";
}

TEST(Instantiate, GivesEachMaterialAnEntityThatSaysWhatItIs) {
  Hall hall;
  gltf::Material& baked = hall.d.materials[1];
  baked.name = "glow";
  baked.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  baked.roughness = 0.25f;
  baked.emissive = {5.0f, 0.0f, 0.0f};
  ecs::Registry registry;
  const SceneInstance scene = instance(registry, hall.d);
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(registry.get<Name>(scene.materials[1]).value, "glow");
  auto& component = registry.get<MaterialComponent>(scene.materials[1]);
  const gltf::Material same = withComponent(baked, component);
  EXPECT_EQ(same.base_color, baked.base_color);
  EXPECT_EQ(same.roughness, baked.roughness);
  EXPECT_EQ(same.emissive, baked.emissive);
  component.roughness = 7.0f;
  component.base_color = {0.5f, std::numeric_limits<float>::quiet_NaN(), 0.5f};
  component.emission_strength = 2.0f;
  const gltf::Material changed = withComponent(baked, component);
  EXPECT_EQ(changed.roughness, baked.roughness) << "out of range";
  EXPECT_EQ(changed.base_color, baked.base_color) << "no colour";
  EXPECT_EQ(changed.emissive, 2.0f * baked.emissive);
}

TEST(RigidGroup, IsWhereTheBakerSaysUntilItMoves) {
  const Hall hall;
  ecs::Registry registry;
  const SceneInstance scene = instance(registry, hall.d);
  updateTransforms(registry);
  const auto& top = registry.get<RigidGroupComponent>(scene.groups[1]);
  EXPECT_EQ(top.rotation, hall.d.groups[1].rest_rotation);
  EXPECT_EQ(top.translation, hall.d.groups[1].rest_translation);
  EXPECT_EQ(top.turn_since_rest, glm::quat(1.0f, 0.0f, 0.0f, 0.0f));
}

TEST(RigidGroup, TurnsWithItsNodeInSpiteOfMirrorsAndStretch) {
  const Hall hall;
  ecs::Registry registry;
  const SceneInstance scene = instance(registry, hall.d);
  const ecs::Entity node = nodeOf(scene, hall.top);
  const Transform rest = registry.get<Transform>(node);
  const std::uint64_t scene_version = registry.version<RigidGroupComponent>(scene.groups[0]);

  const glm::quat turn = glm::angleAxis(glm::radians(70.0f), glm::normalize(glm::vec3(1.0f, 2.0f, -1.0f)));
  Transform& moving = registry.edit<Transform>(node);
  moving.rotation = turn * rest.rotation;
  moving.translation = {1.0f, 4.0f, 2.0f};
  moving.scale *= 1.7f;
  updateTransforms(registry);
  const auto& top = registry.get<RigidGroupComponent>(scene.groups[1]);
  EXPECT_NEAR(std::abs(glm::dot(top.turn_since_rest, turn)), 1.0f, kRounding);
  EXPECT_NEAR(std::abs(glm::dot(top.rotation, turn * hall.d.groups[1].rest_rotation)), 1.0f, kRounding);
  EXPECT_LT(glm::distance(top.translation, glm::vec3(1.0f, 4.0f, 2.0f)), kRounding);
  EXPECT_EQ(registry.version<RigidGroupComponent>(scene.groups[0]), scene_version) << "the hall did not move";

  registry.edit<Transform>(node) = rest;
  updateTransforms(registry);
  EXPECT_NEAR(std::abs(top.turn_since_rest.w), 1.0f, 1e-7f) << "and back, without drift";
  EXPECT_LT(glm::distance(top.translation, hall.d.groups[1].rest_translation), kRounding);
}

TEST(RigidGroup, KeepsItsLastRotationWhileItIsFlatOrMirrored) {
  const Hall hall;
  ecs::Registry registry;
  const SceneInstance scene = instance(registry, hall.d);
  for (const float scale_x : {0.0f, 1.0f}) {  // at rest it is -1
    registry.edit<Transform>(nodeOf(scene, hall.top)).scale.x = scale_x;
    updateTransforms(registry);
    EXPECT_EQ(registry.get<RigidGroupComponent>(scene.groups[1]).rotation, hall.d.groups[1].rest_rotation);
  }
}

TEST(StableId, IsOneForEachEntityAndTheSameInEverySession) {
  const Hall hall;
  ecs::Registry first, second;
  second.create();  // handles differ, ids do not
  const SceneInstance a = instance(first, hall.d), b = instance(second, hall.d);
  std::set<StableId> ids;
  for (auto [entity, id] : first.view<StableId>()) EXPECT_TRUE(ids.insert(id).second);
  EXPECT_EQ(ids.size(), 16u);
  for (auto [entity, id] : second.view<StableId>()) EXPECT_TRUE(ids.contains(id));
  EXPECT_EQ(first.get<StableId>(a.draws[2]), second.get<StableId>(b.draws[2]));
  // Written down once: a change would orphan every world file.
  EXPECT_EQ(instanceId("hall.lmb.glb", 0).value, 8499029866050104862u);
}

TEST(StableId, OutlivesReimportWithNodesAddedAndReordered) {
  const Hall hall;
  // The new file has a root before all others and a node in between, so the indices shift.
  bundle::Description d;
  addNode(d, "sky", -1, glm::mat4(1.0f));
  const std::int32_t top_first = addNode(d, "top", -1, glm::mat4(1.0f));
  const std::int32_t hall_node = addNode(d, "hall", -1, glm::mat4(1.0f));
  const std::int32_t top = addNode(d, "top", hall_node, glm::mat4(1.0f));
  addNode(d, "lamp", hall_node, glm::mat4(1.0f));
  const std::int32_t chair_a = addNode(d, "chair", hall_node, glm::mat4(1.0f));
  const std::int32_t chair_b = addNode(d, "chair", hall_node, glm::mat4(1.0f));
  ecs::Registry before, after;
  const SceneInstance a = instance(before, hall.d), b = instance(after, d);
  const auto same = [&](std::int32_t old_node, std::int32_t new_node) {
    return before.get<StableId>(nodeOf(a, old_node)) == after.get<StableId>(nodeOf(b, new_node));
  };
  EXPECT_TRUE(same(hall.top, top));
  EXPECT_TRUE(same(hall.chair_a, chair_a));
  EXPECT_TRUE(same(hall.chair_b, chair_b));
  EXPECT_FALSE(same(hall.top, top_first)) << "the path counts, not the name alone";
}

TEST(Instantiate, GivesEachLightOfAGroupAnEntityThatKeepsItsId) {
  Hall hall;
  hall.d.materials[1].name = "glow";
  using Kind = bundle::GroupLight::Kind;
  hall.d.lights = {{.name = "eye",
                    .type = gltf::Light::Type::Spot,
                    .color = {0.5f, 1.0f, 1.5f},
                    .intensity = 2.0f,
                    .range_m = 7.0f,
                    .inner_cone_rad = 0.1f,
                    .outer_cone_rad = 0.2f}};
  hall.d.nodes[static_cast<std::size_t>(hall.eye)].light = 0;
  hall.d.groups[0].lights = {{Kind::Node, static_cast<std::uint32_t>(hall.eye), {1.0f, 2.0f, 3.0f}},
                             {Kind::Material, 1, {5.0f, 0.0f, 0.0f}}};
  hall.d.groups[1].lights = {{Kind::Material, 1, {5.0f, 0.0f, 0.0f}}};
  ecs::Registry registry, again;
  const SceneInstance scene = instance(registry, hall.d);
  EXPECT_EQ(registry.entities().size(), 1 + 5 + 2 + 6 + 2 + 2u) << "a lamp is its node";
  ASSERT_EQ(scene.lamps.size(), 2u);
  ASSERT_EQ(scene.lamps[0].size(), 2u);
  EXPECT_EQ(scene.lamps[0][0], nodeOf(scene, hall.eye));
  EXPECT_FALSE(registry.has<LampComponent>(scene.lamps[0][0]));
  const auto& lamp = registry.get<LocalLightComponent>(scene.lamps[0][0]);
  EXPECT_EQ(lamp.kind, LocalLightComponent::Kind::Spot);
  EXPECT_EQ(lamp.power(), glm::vec3(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(lamp.range_m, 7.0f);
  EXPECT_EQ(lamp.inner_cone_rad, 0.1f);
  EXPECT_EQ(lamp.outer_cone_rad, 0.2f);
  EXPECT_EQ(registry.get<LampComponent>(scene.lamps[0][1]).column, 1u);
  EXPECT_EQ(registry.get<LampComponent>(scene.lamps[1][0]).group, 1u);
  EXPECT_EQ(registry.get<Name>(scene.lamps[1][0]).value, "glow");
  registry.edit<LampComponent>(scene.lamps[0][1]).enabled = false;
  EXPECT_EQ(registry.get<LampComponent>(scene.lamps[0][1]).radiance(), glm::vec3(0.0f));
  registry.edit<LocalLightComponent>(scene.lamps[0][0]).enabled = false;
  EXPECT_EQ(registry.get<LocalLightComponent>(scene.lamps[0][0]).power(), glm::vec3(0.0f));
  // Another light before it in the group moves its column, not its id.
  std::swap(hall.d.groups[0].lights[0], hall.d.groups[0].lights[1]);
  const SceneInstance other = instance(again, hall.d);
  EXPECT_EQ(registry.get<StableId>(scene.lamps[0][0]), again.get<StableId>(other.lamps[0][1]));
  EXPECT_NE(registry.get<StableId>(scene.lamps[0][1]), registry.get<StableId>(scene.lamps[1][0]));
  destroyInstance(registry, scene);
  EXPECT_EQ(registry.entities().size(), 0u);
}

TEST(Instantiate, TwiceNeedsAnotherInstanceNumberAndDestructionTakesOnlyItsOwn) {
  const Hall hall;
  ecs::Registry registry;
  const SceneInstance first = instance(registry, hall.d);
  const auto again = instantiate(registry, hall.d, {.bundle_index = 3, .bundle_id = "hall.lmb.glb"});
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().line().find("hall.lmb.glb"), std::string::npos);
  const std::size_t count = registry.entities().size();
  const SceneInstance second = instance(registry, hall.d, 1);
  EXPECT_NE(registry.get<StableId>(first.draws[0]), registry.get<StableId>(second.draws[0]));
  destroyInstance(registry, first);
  EXPECT_EQ(registry.entities().size(), count);
  updateTransforms(registry);
  EXPECT_FALSE(worldBounds(registry).empty());
  destroyInstance(registry, second);
  EXPECT_EQ(registry.entities().size(), 0u);
  EXPECT_TRUE(worldBounds(registry).empty());
}

}  // namespace
}  // namespace lambent::scene
