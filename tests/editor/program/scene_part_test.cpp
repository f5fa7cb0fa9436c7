// Tests which part of the view becomes the small picture of a scene.
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "editor/session/assets.hpp"

namespace lambent::editor {
namespace {

// A square view of 90 degrees from 10 m: a metre at the origin's depth has 40 of 800 pixels.
spec::View view() {
  return {.view_from_world = glm::lookAt(glm::vec3(0, 0, 10), glm::vec3(0), glm::vec3(0, 1, 0)),
          .clip_from_view = glm::perspective(glm::radians(90.0f), 1.0f, 0.1f, 100.0f),
          .eye_ws = {0, 0, 10}};
}
constexpr spec::Size kViewSize{800, 800};

scene::Box flatBox(glm::vec2 center, glm::vec2 half) {
  return {.min = glm::vec3(center - half, 0.0f), .max = glm::vec3(center + half, 0.0f)};
}

TEST(ScenePart, IsTheBoxWithAMarginInTheShapeOfSmallPictures) {
  // The box is 320 x 180 pixels large, about (480, 360).
  const auto part = partWithBox(view(), kViewSize, flatBox({2.0f, 1.0f}, {4.0f, 2.25f}));
  ASSERT_TRUE(part);
  EXPECT_NEAR(part->width, 1.2 * 320.0, 1.0);
  EXPECT_NEAR(part->height, 1.2 * 180.0, 1.0);
  EXPECT_NEAR(part->left + 0.5 * part->width, 480.0, 1.0);
  EXPECT_NEAR(part->top + 0.5 * part->height, 360.0, 1.0) << "rows count from the top";
  const auto tall = partWithBox(view(), kViewSize, flatBox({0.0f, 0.0f}, {1.0f, 4.0f}));
  ASSERT_TRUE(tall);
  EXPECT_NEAR(tall->height, 1.2 * 320.0, 1.0) << "nothing of it is cut";
  EXPECT_NEAR(tall->width, 16.0 / 9.0 * tall->height, 1.0);
}

TEST(ScenePart, StaysWithinThePicture) {
  const auto part = partWithBox(view(), kViewSize, flatBox({-9.0f, 9.0f}, {0.9f, 0.9f}));
  ASSERT_TRUE(part);
  EXPECT_EQ(part->left, 0u);
  EXPECT_EQ(part->top, 0u);
  EXPECT_FALSE(partWithBox(view(), kViewSize, flatBox({-9.5f, 0.0f}, {0.9f, 0.9f}))) << "cut by the picture";
  EXPECT_FALSE(partWithBox(view(), kViewSize, flatBox({0.0f, 0.0f}, {0.4f, 0.4f}))) << "32 pixels";
  EXPECT_FALSE(partWithBox(view(), kViewSize, {})) << "nothing";
  EXPECT_FALSE(partWithBox(view(), kViewSize, {.min = {-1, -1, 9}, .max = {1, 1, 12}})) << "behind the eye";
}

}  // namespace
}  // namespace lambent::editor
