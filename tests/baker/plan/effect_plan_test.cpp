#include "baker/plan/effect_plan.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace lambent::baker {

namespace {

using testing::grid;
using testing::sceneOf;

bool leavesOut(const Scene& scene, const std::string& words, const std::string& effects = "all") {
  const EffectPlan plan = makePlan(scene, *effectsNamed(effects));
  return std::any_of(plan.left_out.begin(), plan.left_out.end(),
                     [&](const std::string& sentence) { return sentence.find(words) != std::string::npos; });
}

TEST(EffectPlan, BakesDiffuseTransferForSurfacesAndSaysWhy) {
  const EffectPlan plan = makePlan(sceneOf({grid({0, 0, 0}, 1.0f, 1)}), *effectsNamed("all"));
  ASSERT_EQ(plan.effects.size(), 4u);
  EXPECT_EQ(plan.effects[0].effect, "diffuse");
  EXPECT_TRUE(plan.effects[0].baked);
  EXPECT_NE(plan.effects[0].reason.find("1 draw"), std::string::npos);
  EXPECT_EQ(plan.effects[1].effect, "glossy");
  for (std::size_t other = 1; other < plan.effects.size(); ++other) EXPECT_FALSE(plan.effects[other].baked);
  EXPECT_TRUE(plan.left_out.empty());
}

TEST(EffectPlan, SaysWhatTheBakeWillNotShow) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1), grid({0, 1, 0}, 1.0f, 1)});
  const std::string diffuse_alone = "diffuse";
  EXPECT_FALSE(leavesOut(scene, "Metallic", diffuse_alone));
  scene.materials[0].metallic = 1.0f;
  EXPECT_TRUE(leavesOut(scene, "Metallic", diffuse_alone));
  EXPECT_FALSE(leavesOut(scene, "Metallic")) << "the glossy effect shows it";
  scene.materials[0].unlit = true;  // shows its colour whatever the light, gloss or no gloss
  EXPECT_FALSE(leavesOut(scene, "Metallic", diffuse_alone));
}

TEST(EffectPlan, WarnsAboutAnimationsThatStretchButNotThoseThatGrow) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 1)});
  scene.nodes[0].name = "jelly";
  scene.nodes[0].animated = true;
  scene.nodes[0].trs = gltf::Trs{.scale = {1, 2, 3}};
  gltf::AnimationChannel channel{
      .path = gltf::AnimationChannel::Path::Scale, .times_s = {0, 1}, .values = {1, 2, 3, 2, 4, 6}};
  scene.animations = {{"wobble", {channel}}};
  EXPECT_FALSE(leavesOut(scene, "stretches"));
  scene.animations[0].channels[0].values[5] = 7.0f;
  EXPECT_TRUE(leavesOut(scene, "stretches jelly"));
}

// Tests which light is traced inside a group, on shapes of which it is known.

using testing::box;
using testing::flipped;
using testing::icosphere;

PlannedTransport planned(const Scene& scene) {
  return planTransport(scene, findRigidGroups(scene)).at(0);
}

TEST(PlannedTransport, TracesNothingOnConvexBodiesAndPlanes) {
  for (const auto& mesh :
       {icosphere({1, 2, 3}, 0.5f, 3), box({0, 0, 0}, {1, 2, 3}, 4), grid({0, 0, 0}, 2, 9)}) {
    const PlannedTransport of = planned(sceneOf({mesh}));
    EXPECT_FALSE(of.shadows) << of.shadows_reason;
    EXPECT_FALSE(of.bounces) << of.bounces_reason;
    EXPECT_LE(of.height, kLevel);
  }
}

TEST(PlannedTransport, TracesWhereOneSurfaceSeesAnother) {
  const auto floor = grid({0, 0, 0}, 2.0f, 2);
  // The last is a valley of one degree.
  for (const Scene& scene :
       {sceneOf({flipped(box({0, 0, 0}, {1, 1, 1}, 2))}), sceneOf({floor, icosphere({0, 1, 0}, 0.2f, 1)}),
        sceneOf({floor, testing::transformed(testing::turned(grid({1, 0, 0}, 2.0f, 2), 1.0f, {0, 0, 1}),
                                             glm::translate(glm::mat4(1.0f), {1.0f, 0.0f, 0.0f}))})}) {
    const PlannedTransport of = planned(scene);
    EXPECT_TRUE(of.shadows) << of.shadows_reason;
    EXPECT_TRUE(of.bounces) << of.bounces_reason;
  }
}

TEST(PlannedTransport, KnowsTheBacksOfDoubleSidedSurfaces) {
  Scene plane = sceneOf({grid({0, 0, 0}, 2.0f, 3)}), shell = sceneOf({box({0, 0, 0}, {1, 1, 1}, 1)});
  plane.materials[0].double_sided = shell.materials[0].double_sided = true;
  EXPECT_FALSE(planned(plane).shadows) << "neither side of a plane sees the other";
  EXPECT_TRUE(planned(shell).shadows) << "the inside of a box sees itself";
}

TEST(PlannedTransport, SeesThroughNodesThatMirror) {
  Scene scene = sceneOf({icosphere({0, 0, 0}, 0.5f, 2)});
  scene.nodes[0].parent_from_node = glm::scale(glm::mat4(1.0f), {-1, 2, 1});
  EXPECT_FALSE(planned(scene).shadows);
}

TEST(PlannedTransport, BouncesNothingBetweenBlackSurfaces) {
  Scene scene = sceneOf({grid({0, 0, 0}, 2.0f, 2), icosphere({0, 1, 0}, 0.2f, 1)});
  scene.materials[0].base_color = glm::vec4(0, 0, 0, 1);
  scene.materials[0].specular = 0.0f;
  EXPECT_TRUE(planned(scene).shadows);
  EXPECT_FALSE(planned(scene).bounces);
  EXPECT_EQ(planned(scene).most_reflected, 0.0);
  scene.materials[0].metallic = 1.0f;
  EXPECT_TRUE(planned(scene).bounces) << "a metal reflects more at grazing angles";
}

// Tests of which double-sided surfaces the insides are left out, by what stands within them.

using testing::joined;

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
