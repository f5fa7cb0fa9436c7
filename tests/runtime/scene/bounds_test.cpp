// Tests the intersection of boxes against points in them.
#include "runtime/scene/bounds.hpp"

#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

namespace lambent::scene {

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

}  // namespace lambent::scene
