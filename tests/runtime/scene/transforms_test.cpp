// Tests transforms, and the intersection of boxes against points in them.
#include "runtime/scene/transforms.hpp"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"
#include "tests/runtime/scene/values.hpp"
#include "tests/support/differences.hpp"

namespace lambent::scene {
namespace {

using testing::kRounding;

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
  updateTransforms(registry);
  // Returns the number of matrices that changed.
  const auto changes = [&] {
    const std::uint64_t before = registry.version<WorldTransform>();
    updateTransforms(registry);
    return registry.version<WorldTransform>() - before;
  };
  EXPECT_EQ(changes(), 0u);
  registry.edit<Transform>(leaves[5]).translation.x = 4.0f;
  EXPECT_EQ(changes(), 1u);
  registry.edit<Transform>(branches[3]).translation.x = 4.0f;
  EXPECT_EQ(changes(), 11u);
  registry.edit<Transform>(root).translation.x = 4.0f;
  EXPECT_EQ(changes(), 111u);
  registry.touch<Transform>(root);
  EXPECT_EQ(changes(), 0u) << "a touched Transform that is the same changes nothing";
}

TEST(Transforms, ReparentingMovesTheChild) {
  ecs::Registry registry;
  const ecs::Entity a = makeNode(registry, {}, {1.0f, 0.0f, 0.0f});
  const ecs::Entity b = makeNode(registry, {}, {0.0f, 5.0f, 0.0f});
  const ecs::Entity child = makeNode(registry, a, {0.0f, 0.0f, 1.0f});
  const auto placeBelow = [&](ecs::Entity parent) {
    registry.edit<Transform>(child).parent = parent;
    updateTransforms(registry);
    return place(registry, child);
  };
  EXPECT_EQ(placeBelow(a), glm::vec3(1.0f, 0.0f, 1.0f));
  EXPECT_EQ(placeBelow(b), glm::vec3(0.0f, 5.0f, 1.0f));
  EXPECT_EQ(placeBelow({}), glm::vec3(0.0f, 0.0f, 1.0f));
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
      const std::size_t child = random() % nodes.size();  // parents come before children, so no cycles
      if (child > 0) registry.edit<Transform>(nodes[child]).parent = nodes[random() % child];
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
  updateTransforms(registry);
  EXPECT_EQ(place(registry, chain.front()).x, 100000.0f);
}

float largestDifference(const glm::mat4& a, const glm::mat4& b) {
  float largest = 0.0f;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) largest = testing::larger(largest, std::abs(a[j][i] - b[j][i]));
  }
  return largest;
}

float roundTripError(const glm::mat4& matrix) {
  Transform transform;
  setLocalMatrix(transform, matrix);
  return largestDifference(localMatrix(transform), matrix);
}

glm::quat randomTurn(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return glm::normalize(glm::quat(normal(random), normal(random), normal(random), normal(random)));
}

TEST(Affine, TranslationRotationScaleComeBackAsTheyWere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> size(0.1f, 3.0f);
  for (int i = 0; i < 200; ++i) {
    Transform made;
    made.translation = {size(random), -size(random), size(random)};
    made.rotation = randomTurn(random);
    made.scale = {size(random), size(random), size(random)};
    Transform found;
    setLocalMatrix(found, localMatrix(made));
    EXPECT_NEAR(std::abs(glm::dot(found.rotation, made.rotation)), 1.0f, kRounding);
    EXPECT_LT(glm::distance(found.scale, made.scale), kRounding);
    EXPECT_LT(glm::length(found.shear), 10.0f * kRounding)
        << "scales of 0.1 against 3 divide the rounding by 0.1";
    EXPECT_EQ(found.translation, made.translation);
  }
}

TEST(Affine, AnyMatrixMirroredOrShearedRoundTrips) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> entry(-2.0f, 2.0f);
  int mirrored = 0;
  for (int i = 0; i < 500; ++i) {
    glm::mat4 matrix(1.0f);
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 3; ++k) matrix[j][k] = entry(random);
    }
    mirrored += glm::determinant(matrix) < 0.0f ? 1 : 0;
    EXPECT_LT(roundTripError(matrix), kRounding);
  }
  EXPECT_GT(mirrored, 100);
}

TEST(Affine, PolarRotationIgnoresAnyStretchAlongAnyAxes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> stretch(-3.0, 3.0);  // 1e-3 .. 1e3
  for (int i = 0; i < 200; ++i) {
    const glm::quat turn = randomTurn(random);
    const glm::dmat3 axes = glm::mat3_cast(glm::dquat(randomTurn(random)));
    glm::dmat3 sizes(0.0);
    // Lengths within a factor of 100 of each other, at any overall size.
    const double overall = std::pow(10.0, stretch(random));
    for (int j = 0; j < 3; ++j) sizes[j][j] = overall * std::pow(10.0, stretch(random) / 3.0);
    const auto found = polarRotation(glm::mat3_cast(glm::dquat(turn)) * axes * sizes * glm::transpose(axes));
    ASSERT_TRUE(found);
    EXPECT_NEAR(std::abs(glm::dot(*found, turn)), 1.0f, kRounding);
  }
}

TEST(Affine, FlatAndMirroredMatricesHaveNoRotation) {
  glm::dmat3 flat(1.0), mirror(1.0), nan(1.0);
  flat[2][2] = 0.0;
  mirror[0][0] = -1.0;
  nan[1][1] = std::nan("");
  EXPECT_FALSE(polarRotation(flat));
  EXPECT_FALSE(polarRotation(mirror));
  EXPECT_FALSE(polarRotation(nan));
  EXPECT_FALSE(polarRotation(glm::dmat3(0.0)));
}

TEST(Boxes, TurnedAtAnEdgeTheyMeetJustWhereTheEdgeReaches) {
  const Box box{glm::vec3(-1.0f), glm::vec3(1.0f)};
  const glm::mat4 turned = glm::mat4_cast(glm::angleAxis(glm::radians(45.0f), glm::vec3(0, 0, 1)));
  const auto at = [&](float x) { return glm::translate(glm::mat4(1.0f), glm::vec3(x, 0.0f, 0.0f)); };
  EXPECT_TRUE(meet(box, glm::mat4(1.0f), box, at(1.99f)));
  EXPECT_FALSE(meet(box, glm::mat4(1.0f), box, at(2.01f)));
  EXPECT_TRUE(meet(box, glm::mat4(1.0f), box, at(2.41f) * turned)) << "1 + sqrt 2";
  EXPECT_FALSE(meet(box, glm::mat4(1.0f), box, at(2.42f) * turned));
  EXPECT_TRUE(meet(box, glm::mat4(1.0f), {glm::vec3(-0.1f), glm::vec3(0.1f)}, turned))
      << "one within the other";
  EXPECT_FALSE(meet(box, glm::mat4(1.0f), Box{}, glm::mat4(1.0f)));
  EXPECT_TRUE(meet(box, at(1e6f), box, at(1e6f + 1.5f))) << "far from the origin";
}

TEST(Boxes, MeetWhereverAPointOfOneIsInTheOther) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const auto place = [&] {
    const glm::quat turn =
        glm::normalize(glm::quat(normal(random), normal(random), normal(random), normal(random)));
    glm::mat4 matrix = glm::scale(glm::mat4_cast(turn), glm::vec3(0.3f + uniform(random)));
    matrix[3] = glm::vec4(0.7f * normal(random), 0.7f * normal(random), 0.7f * normal(random), 1.0f);
    return matrix;
  };
  const Box a{glm::vec3(-1.0f, -0.2f, -0.5f), glm::vec3(1.0f, 0.3f, 0.5f)},
      b{glm::vec3(0.0f), glm::vec3(1.0f)};
  int met = 0, apart = 0;
  for (int round = 0; round < 500; ++round) {
    const glm::mat4 world_from_a = place(), world_from_b = place();
    const glm::mat4 b_from_a = glm::inverse(world_from_b) * world_from_a;
    bool shared = false;
    for (int i = 0; i < 4000 && !shared; ++i) {
      const glm::vec3 at =
          a.min + (a.max - a.min) * glm::vec3(uniform(random), uniform(random), uniform(random));
      const glm::vec3 in_b(b_from_a * glm::vec4(at, 1.0f));
      shared = glm::all(glm::greaterThanEqual(in_b, b.min)) && glm::all(glm::lessThanEqual(in_b, b.max));
    }
    const bool claim = meet(a, world_from_a, b, world_from_b);
    EXPECT_EQ(claim, meet(b, world_from_b, a, world_from_a));
    EXPECT_TRUE(claim || !shared);
    met += shared ? 1 : 0;
    apart += claim ? 0 : 1;
  }
  EXPECT_GT(met, 50);
  EXPECT_GT(apart, 50) << "and not always";
  EXPECT_GT(met + apart, 470) << "few are too small a share for 4000 points";
}

}  // namespace
}  // namespace lambent::scene
