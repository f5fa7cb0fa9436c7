// Tests of which double-sided surfaces the insides are left out, by what stands within them.
#include <algorithm>

#include <gtest/gtest.h>

#include "baker/plan/effect_plan.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::icosphere;
using testing::joined;
using testing::sceneOf;

// Returns how many backs a scene keeps whose materials are all double-sided.
std::size_t backs(Scene scene) {
  for (gltf::Material& material : scene.materials) material.double_sided = true;
  std::vector<RigidGroup> groups = findRigidGroups(scene);
  leaveOutInsides(scene, groups);
  std::size_t count = 0;
  for (const RigidGroup& group : groups)
    count += static_cast<std::size_t>(std::ranges::count_if(group.draws, &PlannedDraw::back));
  return count;
}

bundle::MeshData shell() {
  return box({0, 0, 0}, {2, 2, 2}, 3);
}

void placeNode(Scene& scene, glm::vec3 place) {
  scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
  scene.nodes.emplace_back().parent_from_node = glm::translate(glm::mat4(1.0f), place);
}

TEST(ClosedBodies, HaveNoInsides) {
  EXPECT_EQ(backs(sceneOf({shell()})), 0u);
  EXPECT_EQ(backs(sceneOf({icosphere({5, 0, 0}, 0.5f, 2), shell()})), 0u);
  EXPECT_EQ(backs(sceneOf({joined(shell(), icosphere({5, 0, 0}, 0.5f, 2))})), 0u) << "two parts of a mesh";
  EXPECT_EQ(backs(sceneOf({shell(), box({1, 0, 0}, {1, 1, 1}, 2)})), 0u) << "one only reaches into the other";
}

TEST(ClosedBodies, KeepBothSidesOfWhatIsOpen) {
  bundle::MeshData open = shell();
  open.indices.resize(open.indices.size() - 3);
  EXPECT_EQ(backs(sceneOf({open})), 1u);
  EXPECT_EQ(backs(sceneOf({joined(shell(), testing::grid({9, 0, 0}, 1, 1))})), 1u) << "a part of the mesh";
  EXPECT_EQ(backs(sceneOf({flipped(shell())})), 1u) << "its faces look at the inside";
}

TEST(ClosedBodies, KeepBothSidesAroundThings) {
  EXPECT_EQ(backs(sceneOf({shell(), icosphere({0, 0, 0}, 0.3f, 1)})), 1u) << "of the shell alone";
  EXPECT_EQ(backs(sceneOf({joined(shell(), icosphere({0, 0, 0}, 0.3f, 1))})), 1u) << "as one mesh";
  for (const glm::vec3& place : {glm::vec3(0.2f), glm::vec3(1.2f)}) {
    const std::size_t kept = place.x < 1.0f ? 1 : 0;
    Scene camera = sceneOf({shell()}), lamp = camera, sun = camera, volume = camera;
    for (Scene* scene : {&camera, &lamp, &sun, &volume}) placeNode(*scene, place);
    camera.cameras.emplace_back();
    camera.nodes.back().camera = 0;
    EXPECT_EQ(backs(camera), kept);
    lamp.lights.emplace_back();
    lamp.nodes.back().light = 0;
    EXPECT_EQ(backs(lamp), kept);
    sun.lights.emplace_back().type = gltf::Light::Type::Directional;
    sun.nodes.back().light = 0;
    EXPECT_EQ(backs(sun), 0u);
    volume.volumes.emplace_back().node = static_cast<std::uint32_t>(volume.nodes.size() - 1);
    EXPECT_EQ(backs(volume), kept);
  }
}

TEST(ClosedBodies, KeepBothSidesOfWhatLetsLightThroughOrEmitsIt) {
  for (const gltf::AlphaMode mode : {gltf::AlphaMode::Mask, gltf::AlphaMode::Blend}) {
    Scene scene = sceneOf({shell()});
    scene.materials[0].alpha_mode = mode;
    EXPECT_EQ(backs(scene), 1u);
  }
  Scene lamp = sceneOf({shell()});
  lamp.materials[0].emissive = glm::vec3(1.0f);
  EXPECT_EQ(backs(lamp), 1u);
}

TEST(ClosedBodies, StandAnywhereAndInAnyHand) {
  Scene scene = sceneOf({shell(), icosphere({0, 0, 0}, 0.3f, 1)});
  scene.nodes[0].parent_from_node = glm::scale(glm::mat4(1.0f), {-1e-3f, 2e-3f, 1e-3f});
  EXPECT_EQ(backs(scene), 1u) << "the shell stands within the ball now, and mirrors";
  scene.nodes[0].parent_from_node = glm::translate(glm::mat4(1.0f), {1e4f, 0, 0});
  EXPECT_EQ(backs(scene), 0u);
}

}  // namespace
}  // namespace lambent::baker
