// Tests which part of the world a key light's shadow map covers.
#include <cmath>
#include <limits>
#include <random>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "runtime/shadows/key_shadows.hpp"
#include "tests/runtime/shadows/random.hpp"
#include "tests/support/differences.hpp"

namespace lambent::frame {
namespace {

struct RandomPlaces : testing::Random<double> {
  RandomPlaces() : Random(3) {}
  glm::dvec3 inBox(const scene::Box& box) {
    return glm::mix(glm::dvec3(box.min), glm::dvec3(box.max),
                    glm::dvec3(number(0, 1), number(0, 1), number(0, 1)));
  }
};

glm::mat4 viewFrom(glm::vec3 eye, glm::vec3 target, float fov_deg, float far = 100.0f) {
  return glm::perspective(glm::radians(fov_deg), 16.0f / 9.0f, 0.05f, far) *
         glm::lookAt(eye, target, glm::vec3(0.1f, 1.0f, 0.05f));
}

bool sees(const glm::mat4& clip_from_world, glm::dvec3 p) {
  const glm::dvec4 clip = glm::dmat4(clip_from_world) * glm::dvec4(p, 1.0);
  return std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w && std::abs(clip.z) <= clip.w;
}

// Returns by how many metres a point, with the cone from it up to the top, exceeds the region.
double outside(const KeyRegion& region, glm::dvec3 p, double tan_radius) {
  const glm::dvec2 place(glm::dot(region.right, p), glm::dot(region.up, p));
  const double along = glm::dot(region.towards, p), reach = tan_radius * (region.top - along);
  double most = testing::larger(along - region.top, region.top - region.range - along);
  for (int i = 0; i < 2; ++i)
    for (const double by : {place[i] + reach - region.max[i], region.min[i] - (place[i] - reach)})
      most = testing::larger(most, by);
  return most;
}

const scene::Box kBox{.min = {-2, 0, -1}, .max = {3, 1.5f, 2}};

}  // namespace

TEST(KeyRegion, HoldsAllOfTheBoxThatIsSeenAndWhatLightItGets) {
  RandomPlaces random;
  int seen_points = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 eye = glm::vec3(random.number(0.1, 6.0) * random.direction());
    const glm::mat4 view = viewFrom(eye, glm::vec3(random.inBox(kBox)),
                                    static_cast<float>(random.number(10, 110)), i % 3 == 0 ? 2.0f : 100.0f);
    const std::vector<glm::dvec3> corners = seenCorners(kBox, view);
    const glm::dvec3 towards = random.direction();
    const double tan_radius = random.number(0.001, 0.3);
    const auto region = regionOf(corners, towards, tan_radius, kBox);
    for (int j = 0; j < 200; ++j) {
      const glm::dvec3 p = random.inBox(kBox);
      if (!sees(view, p)) continue;
      ++seen_points;
      ASSERT_TRUE(region);
      ASSERT_LT(outside(*region, p, tan_radius), 1e-5);
    }
    if (!region) continue;
    // The axes are orthonormal.
    EXPECT_NEAR(glm::length(region->right), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(glm::cross(region->right, region->up) - region->towards), 0.0, 1e-12);
    // Everything that can cast a shadow on it is below the top.
    for (int c = 0; c < 8; ++c) {
      const glm::dvec3 corner((c & 1) != 0 ? kBox.max.x : kBox.min.x, (c & 2) != 0 ? kBox.max.y : kBox.min.y,
                              (c & 4) != 0 ? kBox.max.z : kBox.min.z);
      EXPECT_LE(glm::dot(towards, corner), region->top + 1e-6);
    }
  }
  EXPECT_GT(seen_points, 5000);
}

TEST(KeyRegion, IsHardlyLargerThanWhatMustBeShown) {
  RandomPlaces random;
  for (int i = 0; i < 60; ++i) {
    // Half of the views see the whole box.
    const glm::mat4 view = i % 2 == 0 ? viewFrom({9, 7, 8}, {0.5f, 0.7f, 0.5f}, 60.0f)
                                      : viewFrom(glm::vec3(3.0 * random.direction()), glm::vec3(0.5f), 40.0f);
    const std::vector<glm::dvec3> corners = seenCorners(kBox, view);
    if (corners.empty()) continue;
    const glm::dvec3 towards = random.direction();
    const double tan_radius = i % 3 == 0 ? 0.1 : 0.005;
    const auto region = regionOf(corners, towards, tan_radius, kBox);
    ASSERT_TRUE(region);
    // The area is compared with the smallest rectangle about the same points, over fine rotation steps.
    double least = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < 900; ++turn) {
      const double angle = glm::radians(0.1 * turn);
      const glm::dvec3 right = std::cos(angle) * region->right + std::sin(angle) * region->up;
      const glm::dvec3 up = glm::cross(towards, right);
      glm::dvec2 low(1e30), high(-1e30);
      for (const glm::dvec3& p : corners) {
        const glm::dvec2 place(glm::dot(right, p), glm::dot(up, p));
        const double reach = tan_radius * (region->top - glm::dot(towards, p));
        low = glm::min(low, place - reach);
        high = glm::max(high, place + reach);
      }
      least = testing::smaller(least, (high.x - low.x) * (high.y - low.y));
    }
    EXPECT_LT(region->area(), 1.3 * least);
    EXPECT_GE(region->area(), 0.999 * least);
  }
}

TEST(KeyRegion, IsNoneWhereNothingIsSeen) {
  EXPECT_TRUE(seenCorners(kBox, viewFrom({9, 7, 8}, {18, 14, 16}, 60.0f)).empty()) << "it looks away";
  EXPECT_TRUE(seenCorners(kBox, viewFrom({90, 7, 8}, {0, 0, 0}, 60.0f, 10.0f)).empty()) << "it ends before";
  EXPECT_TRUE(seenCorners(scene::Box{}, viewFrom({9, 7, 8}, {0, 0, 0}, 60.0f)).empty()) << "no box";
  EXPECT_FALSE(regionOf({}, glm::dvec3(0, 1, 0), 0.01, kBox));
}

TEST(KeyRegion, TinyAndFarBoxesAndFlatOnesHaveOne) {
  for (const float size : {1e-5f, 1e-2f, 1e3f, 1e5f})
    for (const glm::vec3 offset : {glm::vec3(0), glm::vec3(1e4f, 10, -3e3f)})
      for (const glm::vec3 shape : {glm::vec3(1), {1, 0, 1}, {0, 1, 1}}) {
        const glm::vec3 center = size * offset, half = 0.5f * size * shape;
        const scene::Box box{.min = center - half, .max = center + half};
        // Floats still resolve a ten-thousandth of the distance from the origin.
        const glm::mat4 view = glm::perspective(1.0f, 1.5f, 0.1f * size, 100.0f * size) *
                               glm::lookAt(center + size * glm::vec3(1, 2, 3), center, glm::vec3(0, 1, 0));
        const std::vector<glm::dvec3> corners = seenCorners(box, view);
        for (const glm::dvec3 towards :
             {glm::dvec3(0, 1, 0), {0, -1, 0}, {1, 0, 0}, glm::normalize(glm::dvec3(1, 1, 1))}) {
          const auto region = regionOf(corners, towards, 0.05, box);
          ASSERT_TRUE(region) << size << " offset " << offset.x;
          const double doubt = 1e-5 * double{size} + 1e-5 * double{glm::length(center)};
          EXPECT_LT(outside(*region, glm::dvec3(center), 0.05), doubt) << size << " offset " << offset.x;
          EXPECT_TRUE(std::isfinite(region->area()) && region->range >= 0.0);
          EXPECT_LT(region->area(), 5.0 * double{size} * double{size});
        }
      }
}

TEST(KeyRegion, OneHoldsAnotherOfTheSameAxesWithinIt) {
  const auto whole =
      regionOf(seenCorners(kBox, viewFrom({9, 7, 8}, {0.5f, 0.7f, 0.5f}, 60.0f)), {0, 1, 0}, 0.01, kBox);
  ASSERT_TRUE(whole);
  KeyRegion part = *whole;
  EXPECT_TRUE(whole->holds(part));
  part.min += 0.1;
  part.max -= 0.1;
  EXPECT_TRUE(whole->holds(part));
  EXPECT_FALSE(part.holds(*whole));
  KeyRegion deeper = *whole, turned = *whole;
  deeper.range += 0.1;
  turned.right = whole->up;
  EXPECT_FALSE(whole->holds(deeper));
  EXPECT_TRUE(deeper.holds(*whole));
  EXPECT_FALSE(whole->holds(turned));
}

}  // namespace lambent::frame
