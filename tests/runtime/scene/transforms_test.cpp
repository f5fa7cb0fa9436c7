#include "runtime/scene/transforms.hpp"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/scene/affine.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::scene {
namespace {

ecs::Entity makeNode(ecs::Registry& registry, ecs::Entity parent, glm::vec3 translation) {
  const ecs::Entity entity = registry.create();
  Transform transform;
  transform.translation = translation;
  transform.parent = parent;
  registry.emplace<Transform>(entity, transform);
  return entity;
}

glm::vec3 place(const ecs::Registry& registry, ecs::Entity entity) {
  return glm::vec3(registry.get<WorldTransform>(entity).world_from_node[3]);
}

TEST(Transforms, OnlyWhatChangedIsComputedAgain) {
  ecs::Registry registry;
  const ecs::Entity root = makeNode(registry, {}, {});
  std::vector<ecs::Entity> branches, leaves;
  for (int i = 0; i < 10; ++i) {
    branches.push_back(makeNode(registry, root, {1.0f, 0.0f, 0.0f}));
    for (int j = 0; j < 10; ++j) leaves.push_back(makeNode(registry, branches.back(), {0.0f, 1.0f, 0.0f}));
  }
  EXPECT_EQ(updateTransforms(registry).nodes, 111u);
  const std::uint64_t at_rest = registry.version<WorldTransform>();
  EXPECT_EQ(updateTransforms(registry).nodes, 0u);
  EXPECT_EQ(registry.version<WorldTransform>(), at_rest);

  registry.edit<Transform>(leaves[5]).translation.x = 4.0f;
  EXPECT_EQ(updateTransforms(registry).nodes, 1u);
  registry.edit<Transform>(branches[3]).translation.x = 4.0f;
  EXPECT_EQ(updateTransforms(registry).nodes, 11u);
  registry.edit<Transform>(root).translation.x = 4.0f;
  EXPECT_EQ(updateTransforms(registry).nodes, 111u);

  // A touched Transform that is unchanged is visited once, and nothing follows from it.
  const std::uint64_t before = registry.version<WorldTransform>();
  registry.touch<Transform>(root);
  EXPECT_EQ(updateTransforms(registry).nodes, 1u);
  EXPECT_EQ(registry.version<WorldTransform>(), before);
}

TEST(Transforms, ReparentingMovesTheChildAndRefusesCycles) {
  ecs::Registry registry;
  const ecs::Entity a = makeNode(registry, {}, {1.0f, 0.0f, 0.0f});
  const ecs::Entity b = makeNode(registry, {}, {0.0f, 5.0f, 0.0f});
  const ecs::Entity child = makeNode(registry, a, {0.0f, 0.0f, 1.0f});
  updateTransforms(registry);
  EXPECT_EQ(place(registry, child), glm::vec3(1.0f, 0.0f, 1.0f));
  ASSERT_TRUE(setParent(registry, child, b));
  EXPECT_EQ(updateTransforms(registry).nodes, 1u);
  EXPECT_EQ(place(registry, child), glm::vec3(0.0f, 5.0f, 1.0f));

  const std::uint64_t version = registry.version<Transform>();
  EXPECT_FALSE(setParent(registry, b, child));
  EXPECT_FALSE(setParent(registry, b, b));
  EXPECT_FALSE(setParent(registry, b, registry.create())) << "an entity without a Transform is no parent";
  EXPECT_EQ(registry.version<Transform>(), version);

  ASSERT_TRUE(setParent(registry, child, {}));
  updateTransforms(registry);
  EXPECT_EQ(place(registry, child), glm::vec3(0.0f, 0.0f, 1.0f));
}

TEST(Transforms, RandomEditsGiveWhatComputingAllFromNothingGives) {
  ecs::Registry registry;
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  std::vector<ecs::Entity> nodes;
  for (int step = 0; step < 2000; ++step) {
    const auto pick = [&] { return nodes[random() % nodes.size()]; };
    const auto what = random() % 6;
    if (what <= 1 || nodes.size() < 3) {
      const ecs::Entity parent = nodes.empty() ? ecs::Entity{} : pick();
      nodes.push_back(makeNode(registry, parent, {normal(random), normal(random), normal(random)}));
    } else if (what <= 3) {
      registry.edit<Transform>(pick()).rotation =
          glm::normalize(glm::quat(normal(random), normal(random), normal(random), normal(random)));
    } else if (what == 4) {
      setParent(registry, pick(), pick());
    } else if (random() % 4 == 0) {
      const std::size_t at = random() % nodes.size();
      registry.destroy(nodes[at]);
      nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(at));
    }
    if (step % 7 != 0) continue;
    updateTransforms(registry);
    for (const ecs::Entity node : nodes) {
      glm::mat4 expected(1.0f);
      std::vector<ecs::Entity> chain;
      for (ecs::Entity at = node; registry.has<Transform>(at); at = registry.get<Transform>(at).parent) {
        chain.push_back(at);
      }
      for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
        expected = it == chain.rbegin() ? localMatrix(registry.get<Transform>(*it))
                                        : expected * localMatrix(registry.get<Transform>(*it));
      }
      for (int column = 0; column < 4; ++column)
        ASSERT_LT(glm::distance(registry.get<WorldTransform>(node).world_from_node[column], expected[column]),
                  1e-4f)
            << "at step " << step;
    }
  }
}

TEST(Transforms, AHundredThousandLevelsDoNotOverflowTheStack) {
  ecs::Registry registry;
  std::vector<ecs::Entity> chain;
  for (int i = 0; i < 100000; ++i) chain.push_back(makeNode(registry, {}, {1.0f, 0.0f, 0.0f}));
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) registry.edit<Transform>(chain[i]).parent = chain[i + 1];
  EXPECT_EQ(updateTransforms(registry).nodes, chain.size());
  EXPECT_EQ(place(registry, chain.front()).x, 100000.0f);
  EXPECT_FALSE(setParent(registry, chain.back(), chain.front()));
}

}  // namespace
}  // namespace lambent::scene
