#include "editor/gizmo/sun_gizmo.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "runtime/spec/light.hpp"
#include "views.hpp"

namespace lambent::editor {
namespace {

using testing::kViewport;
using testing::lookAt;

const spec::View kView = lookAt({1.0f, 2.0f, 3.0f}, {0.0f, 2.5f, 0.0f}, true);

bool atBorder(const glm::vec2& pixel) {
  const glm::vec2 low(kViewport.x, kViewport.y);
  const glm::vec2 high = low + glm::vec2(kViewport.width, kViewport.height);
  const float gap = std::min({pixel.x - low.x, pixel.y - low.y, high.x - pixel.x, high.y - pixel.y});
  return gap > 0.0f && gap < 20.0f;
}

TEST(SunGizmo, ASunIsDraggedToWhereThePixelLooks) {
  const Projection projection(kView, kViewport);
  for (const float rotation : {0.0f, 75.0f, -200.0f}) {
    const SkyDirection before = skyDirection(glm::vec3(projection.ray({500.0, 300.0}).direction), rotation);
    SunGizmo gizmo;
    gizmo.setView(kView, kViewport);
    gizmo.setSuns({towardsSun(before, rotation)});
    // Taken beside its middle, it stays where it is until the pointer moves.
    const glm::vec2 taken = gizmo.place(0)->pixel + glm::vec2(4.0f, -3.0f);
    ASSERT_TRUE(gizmo.press(taken));
    EXPECT_NEAR(skyDirection(gizmo.drag(taken), rotation).azimuth_deg, before.azimuth_deg, 1e-3f);
    const SkyDirection there = skyDirection(gizmo.drag(taken + glm::vec2(-200.0f, -180.0f)), rotation);
    gizmo.release();
    gizmo.setSuns({towardsSun(there, rotation)});
    EXPECT_LT(glm::length(gizmo.place(0)->pixel - glm::vec2(300.0f, 120.0f)), 0.01f);
    EXPECT_TRUE(gizmo.place(0)->seen);
  }
}

TEST(SunGizmo, ASunOutsideOfThePictureIsTakenAtItsBorder) {
  const Projection projection(kView, kViewport);
  const glm::vec3 right(projection.right()), up(projection.up()), back(projection.back());
  SunGizmo gizmo;
  gizmo.setView(kView, kViewport);
  // The suns are beyond the right edge in front of the eye and behind it, right behind the eye, and straight
  // up.
  gizmo.setSuns({glm::normalize(right - 0.2f * back), glm::normalize(right + back), back, up});
  const glm::vec2 center(kViewport.x + 400.0f, kViewport.y + 300.0f);
  for (std::size_t sun = 0; sun < gizmo.count(); ++sun) {
    const SunGizmo::Place at = *gizmo.place(sun);
    EXPECT_FALSE(at.seen) << sun;
    EXPECT_TRUE(atBorder(at.pixel)) << sun;
    if (sun < 2)
      EXPECT_GT(at.pixel.x, center.x + 300.0f) << sun;
    else
      EXPECT_LT(at.pixel.y, center.y - 200.0f) << sun;
  }
  // The sun jumps to the pointer.
  gizmo.setSuns({back});
  ASSERT_TRUE(gizmo.press(gizmo.place(0)->pixel));
  const glm::vec3 wanted(projection.ray(glm::dvec2(center)).direction);
  EXPECT_LT(glm::length(gizmo.drag(center) - wanted), 1e-5f);
}

TEST(SunGizmo, ViewsWithoutPerspectiveHaveNoHandles) {
  SunGizmo gizmo;
  gizmo.setView(lookAt({1.0f, 2.0f, 3.0f}, {0.0f, 2.5f, 0.0f}, false), kViewport);
  gizmo.setSuns({{0.0f, 1.0f, 0.0f}});
  EXPECT_FALSE(gizmo.place(0));
  EXPECT_FALSE(gizmo.hit({440.0f, 34.0f}));
  EXPECT_TRUE(gizmo.paint().empty());
}

TEST(SunGizmo, TheWordOfASunChangesByItsAnglesAlone) {
  const Result<std::string> word = withSunDirection("sun:35,45,6,100,92,80", {-170.5f, 12.25f});
  ASSERT_TRUE(word);
  EXPECT_EQ(*word, "sun:-170.5,12.25,6,100,92,80");
  EXPECT_TRUE(spec::parseLight(*word));
  EXPECT_FALSE(withSunDirection("constant:1,1,1", {}));
}

}  // namespace
}  // namespace lambent::editor
