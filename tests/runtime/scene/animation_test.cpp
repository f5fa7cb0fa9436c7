// Tests that animations move the nodes that they name, and only when something changes.
#include "runtime/scene/animation.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/scene/transforms.hpp"
#include "tests/runtime/scene/values.hpp"

namespace lambent::scene {
namespace {

using Path = gltf::AnimationChannel::Path;
using Interpolation = gltf::AnimationChannel::Interpolation;

using testing::kRounding;
using testing::kUp;

gltf::AnimationChannel channel(std::uint32_t node, Path path, std::vector<float> times,
                               std::vector<float> values) {
  return {.node = node,
          .path = path,
          .interpolation = Interpolation::Linear,
          .times_s = std::move(times),
          .values = std::move(values)};
}

// Makes a ball that rolls along x from 0 to 4 in two seconds, then rests until 3, and a top that turns by 90
// degrees about +Y in a second while it grows from 1 to 3, a group of its own with rest scale 2.
struct Playground {
  Playground() {
    d.nodes.resize(3);
    d.roots = {0, 1, 2};
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}}) {
      d.nodes[n].animated = true;
      d.nodes[n].trs = gltf::Trs{.translation = {9.0f, 1.0f, 0.0f}, .scale = glm::vec3(n == 1 ? 2.0f : 1.0f)};
      d.nodes[n].parent_from_node = d.nodes[n].trs->matrix();
    }
    const float half = std::sqrt(0.5f);
    d.animations = {
        {.name = "roll", .channels = {channel(0, Path::Translation, {0, 2, 3}, {0, 1, 0, 4, 1, 0, 4, 1, 0})}},
        {.name = "spin",
         .channels = {channel(1, Path::Rotation, {0, 1}, {0, 0, 0, 1, 0, half, 0, half}),
                      channel(1, Path::Scale, {0, 1}, {1, 1, 1, 3, 3, 3})}}};
    bundle::Group top;
    top.node = 1;
    top.rest_translation = {9.0f, 1.0f, 0.0f};
    top.bounds_min = glm::vec3(-1.0f);
    top.bounds_max = glm::vec3(1.0f);
    d.groups = {top};
    auto made = instantiate(registry, d, {.bundle_index = 5, .bundle_id = "playground"});
    EXPECT_TRUE(made) << made.error().line();
    scene = std::move(*made);
    bundles = {{.bundle = 5, .description = &d, .instance = &scene}};
  }

  AnimationComponent& player(std::size_t i) { return registry.edit<AnimationComponent>(scene.animations[i]); }
  const Transform& node(std::size_t n) { return registry.get<Transform>(scene.nodes[n]); }
  void play(float seconds) { playAnimations(registry, bundles, seconds); }
  void set(float time) { setAnimationTime(registry, bundles, time); }

  bundle::Description d;
  ecs::Registry registry;
  SceneInstance scene;
  std::vector<AnimatedBundle> bundles;
};

TEST(Animation, NodesRestUntilTheyArePlayed) {
  Playground at;
  EXPECT_EQ(at.registry.get<Name>(at.scene.animations[1]).value, "spin");
  at.play(0.0f);
  EXPECT_EQ(at.node(0).translation, glm::vec3(9, 1, 0));
  at.play(0.5f);
  EXPECT_LT(glm::distance(at.node(0).translation, glm::vec3(1, 1, 0)), kRounding);
  EXPECT_LT(glm::distance(at.node(1).scale, glm::vec3(2)), kRounding);
  EXPECT_EQ(at.node(1).translation, glm::vec3(9, 1, 0)) << "no channel, as it was";
}

TEST(Animation, CostsNothingWhilePausedOrAtItsEndOrBetweenEqualKeys) {
  Playground at;
  at.player(0).loop = false;
  at.player(1).playing = false;
  at.play(2.5f);
  const std::uint64_t transforms = at.registry.version<Transform>();
  const std::uint64_t players = at.registry.version<AnimationComponent>();
  at.play(0.25f);
  EXPECT_EQ(at.registry.version<Transform>(), transforms) << "between two equal keys";
  at.play(10.0f);
  EXPECT_EQ(at.player(0).time_s, 3.0f) << "to the end and no farther";
  const std::uint64_t ended = at.registry.version<AnimationComponent>();
  EXPECT_GT(ended, players);
  at.play(1.0f);
  EXPECT_EQ(at.registry.version<AnimationComponent>(), ended);
  EXPECT_EQ(at.registry.version<Transform>(), transforms);
  EXPECT_EQ(at.node(1).scale, glm::vec3(2.0f)) << "paused from the start: at rest";
}

TEST(Animation, LoopsForwardAndBackward) {
  Playground at;
  at.play(3.5f);
  EXPECT_NEAR(at.player(0).time_s, 0.5f, kRounding);
  EXPECT_NEAR(at.player(1).time_s, 0.5f, kRounding);
  EXPECT_NEAR(at.node(0).translation.x, 1.0f, kRounding);
  at.player(0).speed = -2.0f;
  at.play(0.5f);
  EXPECT_NEAR(at.player(0).time_s, 2.5f, kRounding);
  EXPECT_NEAR(at.node(0).translation.x, 4.0f, kRounding);
  at.player(0).loop = false;
  at.play(100.0f);
  EXPECT_EQ(at.player(0).time_s, 0.0f);
  const float time = at.player(1).time_s;
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    at.play(wrong);
  EXPECT_EQ(at.player(0).time_s, 0.0f);
  EXPECT_EQ(at.player(1).time_s, time);
}

TEST(Animation, MovesAsTheBakersPosesDo) {
  Playground at;
  auto nodes = at.d.nodes;
  at.set(0.7f);
  updateTransforms(at.registry);
  gltf::applyAnimations(at.d.animations, 0.7f, nodes);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (int c = 0; c < 4; ++c)
      EXPECT_LT(glm::distance(at.registry.get<WorldTransform>(at.scene.nodes[n]).world_from_node[c],
                              nodes[n].parent_from_node[c]),
                kRounding);
}

// Transfer depends on directions only: a group that scales uniformly behaves as if it only turned.
TEST(Animation, AGroupThatGrowsEvenlyStaysRigid) {
  Playground at;
  for (const float time : {0.0f, 0.25f, 0.6f, 1.0f}) {
    at.set(time);
    updateTransforms(at.registry);
    const auto& top = at.registry.get<RigidGroupComponent>(at.scene.groups[0]);
    const glm::quat turn = glm::angleAxis(glm::radians(90.0f * time), kUp);
    EXPECT_NEAR(std::abs(glm::dot(top.rotation, turn)), 1.0f, 1e-6f) << time;
    EXPECT_LT(glm::distance(top.translation, glm::vec3(9, 1, 0)), kRounding) << "it grows about its place";
    // The scale is 2 at rest and then 1 + 2 t.
    const glm::vec3 grown(top.world_from_rest * glm::vec4(0, 1, 0, 0));
    EXPECT_LT(glm::distance(grown, glm::vec3(0, (1 + 2 * time) / 2, 0)), kRounding);
  }
}

TEST(SceneLights, StandWhereTheirWordsSay) {
  ecs::Registry registry;
  const std::vector<spec::Light> lights = {spec::ConstantLight{},
                                           spec::SphereLight{{1, 2, 3}, 0.5f, {8, 4, 0}},
                                           spec::DiscLight{{0, 5, 0}, {0, -1, 0}, 0.25f, {1, 2, 3}},
                                           spec::DiscLight{{0, 0, 9}, {0, 0, 1}, 1, {0, 0, 0}}};
  const auto entities = addLights(registry, lights);
  ASSERT_EQ(entities.size(), 3u);
  updateTransforms(registry);
  const auto light = [&](std::size_t i) { return registry.get<LocalLightComponent>(entities[i]); };
  const auto place = [&](std::size_t i) { return registry.get<WorldTransform>(entities[i]).world_from_node; };
  EXPECT_EQ(light(0).kind, LocalLightComponent::Kind::Sphere);
  EXPECT_EQ(light(0).power(), glm::vec3(8, 4, 0));
  EXPECT_EQ(light(0).strength, 8.0f);
  EXPECT_EQ(light(0).radius_m, 0.5f);
  EXPECT_EQ(glm::vec3(place(0)[3]), glm::vec3(1, 2, 3));
  EXPECT_EQ(light(1).kind, LocalLightComponent::Kind::Disc);
  EXPECT_LT(glm::distance(light(1).power(), glm::vec3(1, 2, 3)), 1e-6f);
  EXPECT_LT(glm::distance(-glm::vec3(place(1)[2]), glm::vec3(0, -1, 0)), kRounding);
  EXPECT_LT(glm::distance(-glm::vec3(place(2)[2]), glm::vec3(0, 0, 1)), kRounding) << "half a turn";
  EXPECT_EQ(light(2).power(), glm::vec3(0)) << "dark";
  const ecs::Entity environment = addEnvironment(registry, {.intensity = 2.0f, .fade = 0.5f});
  EXPECT_EQ(registry.get<EnvironmentComponent>(environment).fade, 0.5f);
}

}  // namespace
}  // namespace lambent::scene
