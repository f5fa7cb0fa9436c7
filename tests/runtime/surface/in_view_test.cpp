// Tests what counts as out of view.
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/draws/surface_record.hpp"

namespace lambent::frame {
namespace {

scene::Box cubeAt(glm::vec3 center) {
  return {center - 0.5f, center + 0.5f};
}

TEST(OutOfView, IsWhatLiesBeyondAPlaneOfTheFrustum) {
  const glm::mat4 perspective = glm::perspective(glm::radians(90.0f), 1.0f, 0.1f, 100.0f);
  EXPECT_FALSE(outOfView(perspective, cubeAt({0, 0, -5})));
  EXPECT_FALSE(outOfView(perspective, cubeAt({5.4f, 0, -5}))) << "a part of it is in view";
  EXPECT_TRUE(outOfView(perspective, cubeAt({6.6f, 0, -5})));
  EXPECT_TRUE(outOfView(perspective, cubeAt({0, 0, 5}))) << "behind the eye";
  EXPECT_TRUE(outOfView(perspective, cubeAt({0, 0, -200})));
  EXPECT_FALSE(outOfView(perspective, {glm::vec3(-50), glm::vec3(50)})) << "the eye is in it";
}

TEST(OutOfView, HoldsForParallelRaysToo) {
  const glm::mat4 flat = glm::ortho(-1.0f, 1.0f, -1.0f, 1.0f, 1.0f, 20.0f);
  EXPECT_FALSE(outOfView(flat, cubeAt({1.4f, 0, -5})));
  EXPECT_TRUE(outOfView(flat, cubeAt({1.6f, 0, -5})));
  EXPECT_TRUE(outOfView(flat, cubeAt({0, 0, 0})));
}

}  // namespace
}  // namespace lambent::frame
