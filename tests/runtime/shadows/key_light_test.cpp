// Compares the visibility of key lights by shadow maps, by the shader as C++, with closed forms and with sums
// over the disc that do not use maps.
#include <array>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "tests/runtime/shadows/random.hpp"
#include "tests/runtime/shadows/shadow_shaders.hpp"
#include "tests/support/differences.hpp"

namespace lambent::frame {
namespace {

using sh::kPi;
constexpr float kDegree = std::numbers::pi_v<float> / 180.0f;
constexpr glm::vec3 kUp(0, 0, 1);
constexpr float kRounding = 1e-6f;  // weights of four texels sum to 1 but for that

using testing::Random;

// Distances along rays are negative if there is no hit.
// Returns the share that is visible where all counts of which the map cannot tell.
float visibleOf(const MadeMap& map, const KeyRecord& key, const glm::vec3& position, const glm::vec3& normal,
                const glm::vec3& shading_normal) {
  const glm::vec2 visible = glsl::KeyShader{&map}.keyVisible(key, position, normal, shading_normal);
  return visible.x + visible.y;
}

constexpr double kMiss = -1.0;
double nearer(double a, double b) {
  return a < 0.0 ? b : b < 0.0 ? a : std::min(a, b);
}

double toPlane(const KeyRay& ray, glm::dvec3 normal, double offset) {
  const double along = glm::dot(normal, ray.direction);
  return along == 0.0 ? kMiss : (offset - glm::dot(normal, ray.from)) / along;
}

struct Slab {
  glm::dvec3 least, most;
};
double toBox(const KeyRay& ray, const Slab& box) {
  double from = 0.0, to = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (ray.direction[i] == 0.0) {
      if (ray.from[i] < box.least[i] || ray.from[i] > box.most[i]) return kMiss;
      continue;
    }
    const double a = (box.least[i] - ray.from[i]) / ray.direction[i],
                 b = (box.most[i] - ray.from[i]) / ray.direction[i];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to ? from : kMiss;
}

double toSphere(const KeyRay& ray, glm::dvec3 center, double radius) {
  const glm::dvec3 from = ray.from - center;
  const double b = glm::dot(from, ray.direction), c = glm::dot(from, from) - radius * radius;
  const double root = b * b - c;
  return root < 0.0 || -b < 0.0 ? kMiss : -b - std::sqrt(root);
}

// Returns the fraction of a disc beyond a line at s radii from its centre.
double beyondChord(double s) {
  s = std::clamp(s, -1.0, 1.0);
  return (std::acos(s) - s * std::sqrt(1.0 - s * s)) / kPi;
}

// Returns the fraction of the disc that is visible from a point, weighted by the cosine, with many more rays
// than the shader uses. blocked(ray) tells whether a ray is occluded.
template <typename Blocked>
double visibleByRays(const KeyRecord& key, glm::vec3 position, glm::vec3 normal, const Blocked& blocked) {
  constexpr int kRays = 3000;
  const glm::dvec3 right{glm::normalize(glm::vec3(key.right))}, up{glm::normalize(glm::vec3(key.up))};
  double visible = 0.0, all = 0.0;
  for (int i = 0; i < kRays; ++i) {
    const glm::dvec2 at = double{key.scale.w} * glm::dvec2(glsl::KeyShader().keyPoint(i, kRays));
    const glm::dvec3 direction = glm::dvec3(glm::vec3(key.towards)) + at.x * right + at.y * up;
    const double weight = std::max(glm::dot(glm::dvec3(normal), direction), 0.0);
    all += weight;
    if (weight > 0.0 && !blocked(KeyRay{glm::dvec3(position), glm::normalize(direction)})) visible += weight;
  }
  return all > 0.0 ? visible / all : 0.0;
}

struct Errors {
  double largest = 0.0, sum = 0.0, signed_sum = 0.0, squares = 0.0;
  int count = 0;
  void add(double error) {
    largest = testing::larger(largest, std::abs(error));
    sum += std::abs(error);
    signed_sum += error;
    squares += error * error;
    ++count;
  }
  double mean() const { return sum / count; }
  double rms() const { return std::sqrt(squares / count); }
  double bias() const { return signed_sum / count; }
};

}  // namespace

TEST(KeyLight, AnEdgeCastsThePenumbraOfADiscThatALineCuts) {
  // A plate over a floor ends in a straight edge. To each side the penumbra's width is the edge's height
  // times the tangent of the radius.
  constexpr int kSize = 512;
  struct Case {
    float degrees, height, half;  // half: of what the map shows
  };
  for (const Case& c : {Case{0.27f, 1.0f, 0.2f},
                        {0.27f, 0.3f, 0.05f},
                        {2, 0.3f, 0.5f},
                        {2, 1, 2},
                        {5, 1, 2},
                        {8, 0.3f, 2},
                        {8, 3, 2}})
    for (const uint rays : {32u, 128u}) {
      Errors errors;
      for (const float turn : {0.0f, 0.5f, 1.3f, 2.9f}) {
        const KeyRecord key = madeKey(kUp, c.degrees * kDegree, c.half, kSize, turn, rays);
        const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) {
          return ray.from.z - (ray.from.x < 0.0 ? double{c.height} : 0.0);
        });
        const double width = double{c.height} * double{key.scale.w};
        for (int i = -40; i <= 40; ++i) {
          const double x = width * i / 40.0;
          const float visible = visibleOf(map, key, {static_cast<float>(x), 0.01f, 0.0f}, kUp, kUp);
          errors.add(double{visible} - beyondChord(-x / width));
        }
        // Beyond the penumbra the light is fully visible or hidden.
        for (const double beyond : {1.1, 1.5, 3.0}) {
          const auto x = static_cast<float>(beyond * width + 1.5 / double{key.scale.x});
          EXPECT_NEAR(visibleOf(map, key, {x, 0.01f, 0.0f}, kUp, kUp), 1.0f, kRounding);
          EXPECT_EQ(visibleOf(map, key, {-x, 0.01f, 0.0f}, kUp, kUp), 0.0f);
        }
      }
      // This is how finely the sample points resolve the part of a disc beyond a line.
      const bool few = rays == 32;
      EXPECT_LT(errors.largest, few ? 0.08 : 0.035) << c.degrees << " degrees, " << c.height << " high";
      EXPECT_LT(errors.mean(), few ? 0.02 : 0.0075) << c.degrees << " degrees, " << c.height << " high";
      EXPECT_LT(std::abs(errors.bias()), few ? 0.008 : 0.002)
          << c.degrees << " degrees, " << c.height << " high";
    }
}

TEST(KeyLight, AnEdgeWhosePenumbraIsFinerThanTexelsIsSharpToATexel) {
  constexpr int kSize = 256;
  for (const float degrees : {0.01f, 0.27f, 1.0f})
    for (const float turn : {0.0f, 0.7f}) {
      const KeyRecord key = madeKey(kUp, degrees * kDegree, 2.0f, kSize, turn);
      const MadeMap map =
          madeMap(key, kSize, [](const KeyRay& ray) { return ray.from.z - (ray.from.x < 0.0 ? 0.5 : 0.0); });
      const float sharp = 1.5f / key.scale.x + 0.5f * key.scale.w;
      float sum = 0.0f;
      constexpr int kPlaces = 200;
      for (int i = 0; i < kPlaces; ++i) {
        const float x = 4.0f * sharp * ((static_cast<float>(i) + 0.5f) / kPlaces - 0.5f);
        const float visible = visibleOf(map, key, {x, 0.01f, 0.0f}, kUp, kUp);
        sum += visible;
        if (std::abs(x) > sharp) {
          EXPECT_NEAR(visible, x > 0.0f ? 1.0f : 0.0f, kRounding) << degrees << " degrees at " << x;
        }
      }
      // The edge's position is exact to half a texel.
      EXPECT_NEAR((sum / kPlaces - 0.5f) * 4.0f * sharp * key.scale.x, 0.0f, 0.51f)
          << "the edge stands where it is";
    }
}

TEST(KeyLight, ABallCastsTheShadowOfADiscThatItCovers) {
  constexpr int kSize = 1024;
  for (const float degrees : {0.27f, 2.0f, 5.0f, 8.0f})
    for (const double radius : {0.1, 0.3}) {
      const glm::vec3 towards = glm::normalize(glm::vec3(0.3f, -0.2f, 1.0f));
      const KeyRecord key = madeKey(towards, degrees * kDegree, 3.0f, kSize, 0.4f);
      const glm::dvec3 center = 1.5 * glm::dvec3(towards);
      const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) {
        return nearer(toPlane(ray, glm::dvec3(kUp), 0.0), toSphere(ray, center, radius));
      });
      Errors errors;
      double shadowed = 0.0;
      for (int i = 0; i < 23; ++i)
        for (int j = 0; j < 23; ++j) {
          const glm::vec3 place(0.05f * static_cast<float>(i - 11), 0.05f * static_cast<float>(j - 11), 0.0f);
          const double expected = visibleByRays(
              key, place, kUp, [&](const KeyRay& ray) { return toSphere(ray, center, radius) >= 0.0; });
          shadowed += 1.0 - expected;
          errors.add(double{visibleOf(map, key, place, kUp, kUp)} - expected);
        }
      // The ball's heights vary; a penumbra narrower than a texel becomes a texel wide.
      EXPECT_LT(errors.largest, 0.2) << degrees << " degrees, radius " << radius;
      EXPECT_LT(errors.mean(), 0.022) << degrees << " degrees, radius " << radius;
      EXPECT_LT(std::abs(errors.bias()), 0.06 * shadowed / errors.count)
          << "the shadow is as dark on the whole";
    }
}

TEST(KeyLight, SeveralBlockersAtSeveralHeightsShadowAsTheyDoTogether) {
  constexpr int kSize = 1024;
  const std::vector<std::array<Slab, 2>> scenes = {
      {{{{-3, -3, 0.3}, {0, 3, 0.35}}, {{0.1, -3, 2.0}, {3, 3, 2.05}}}},       // a slit between them
      {{{{-3, -3, 0.5}, {-0.05, 3, 0.55}}, {{-3, -3, 1.5}, {0.05, 3, 1.6}}}},  // one over the other
      {{{{-0.2, -0.2, 0.3}, {0.2, 0.2, 0.4}},
        {{-0.3, -0.6, 1.8}, {0.3, 0.1, 1.9}}}}};  // one hidden from above
  for (const auto& boxes : scenes)
    for (const float degrees : {0.27f, 2.0f, 5.0f, 8.0f}) {
      const KeyRecord key = madeKey(kUp, degrees * kDegree, 3.0f, kSize);
      const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) {
        return nearer(toPlane(ray, glm::dvec3(kUp), 0.0), nearer(toBox(ray, boxes[0]), toBox(ray, boxes[1])));
      });
      Errors errors;
      for (int i = 0; i < 61; ++i)
        for (int j = 0; j < 9; ++j) {
          const glm::vec3 place(0.02f * static_cast<float>(i - 30) + 0.003f,
                                0.07f * static_cast<float>(j - 4), 0.0f);
          const double expected = visibleByRays(key, place, kUp, [&](const KeyRay& ray) {
            return toBox(ray, boxes[0]) >= 0.0 || toBox(ray, boxes[1]) >= 0.0;
          });
          errors.add(double{visibleOf(map, key, place, kUp, kUp)} - expected);
        }
      const bool hidden = &boxes == &scenes.back();
      EXPECT_LT(errors.mean(), hidden ? 0.035 : 0.015) << degrees << " degrees";
      EXPECT_LT(errors.rms(), hidden ? 0.065 : 0.04) << degrees << " degrees";
      EXPECT_LT(std::abs(errors.bias()), hidden ? 0.02 : 0.01) << degrees << " degrees";
    }
}

TEST(KeyLight, AParapetAlongWhichLightComesBlocksTheRaysThatCrossIt) {
  constexpr int kSize = 1024;
  const Slab parapet{{-3, -0.03, -0.1}, {3, 0.03, 1.0}};
  const glm::vec3 towards = glm::normalize(glm::vec3(0.82f, 0.03f, 0.57f));
  for (const float degrees : {3.0f, 9.0f}) {
    const KeyRecord key = madeKey(towards, degrees * kDegree, 3.0f, kSize);
    const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) {
      return nearer(toPlane(ray, glm::dvec3(kUp), 0.0), toBox(ray, parapet));
    });
    Errors errors;
    double lit = 0.0;
    for (int i = 0; i < 40; ++i)
      for (const float x : {-0.4f, -0.1f, 0.2f}) {
        const glm::vec3 place(x, -0.04f - 0.015f * static_cast<float>(i), 0.0f);
        const double expected =
            visibleByRays(key, place, kUp, [&](const KeyRay& ray) { return toBox(ray, parapet) >= 0.0; });
        lit += expected;
        errors.add(double{visibleOf(map, key, place, kUp, kUp)} - expected);
      }
    EXPECT_LT(std::abs(errors.bias()), 0.065 * lit / errors.count) << degrees << " degrees";
    EXPECT_LT(errors.rms(), 0.095) << degrees << " degrees";
  }
}

TEST(KeyLight, NothingInTheWayIsAllOfTheLightAtAnyTilt) {
  Random<float> random(7);
  for (const int size : {64, 256, 512})
    for (const float degrees : {0.27f, 2.0f, 8.0f})
      for (const float facing : {1.0f, 0.9f, 0.6f, 0.3f, 0.1f, 0.05f, 0.025f}) {
        const glm::vec3 towards = random.direction();
        const glm::vec3 beside = glm::normalize(glm::cross(towards, random.direction()));
        const glm::vec3 normal = facing * towards + std::sqrt(1.0f - facing * facing) * beside;
        const glm::vec3 along = glm::cross(towards, beside), steep = glm::cross(normal, along);
        const KeyRecord key = madeKey(towards, degrees * kDegree, 1.0f, size, random.number(0, 3));
        const float offset = random.number(-0.02f, 0.02f) * facing;
        const MadeMap map = madeMap(key, size, [&](const KeyRay& ray) {
          return std::max(toPlane(ray, glm::dvec3(normal), double{offset}),
                          0.0);  // above the top it is at the top
        });
        for (int i = 0; i < 100; ++i) {
          const glm::vec3 place =
              offset * normal + random.number(-0.6f, 0.6f) * along + random.number(-0.6f, 0.6f) * steep;
          ASSERT_NEAR(visibleOf(map, key, place, normal, normal), 1.0f, kRounding)
              << degrees << " degrees, " << size << " texels, cosine " << facing;
          // Much of the disc may be behind the plane, and the map is sure of the rest.
          ASSERT_NEAR(glsl::KeyShader{&map}.keyVisible(key, place, normal, normal).y, 0.0f, kRounding)
              << degrees << " degrees, " << size << " texels, cosine " << facing;
        }
      }
}

// The upper edge of a cornice is nearer to the ceiling than faces of one lit surface are to each other.
TEST(KeyLight, WhatComesThroughACeilingThatAWallTouchesIsInDoubt) {
  constexpr int kSize = 512;
  for (const float degrees : {0.27f, 2.0f, 9.0f})
    for (const float facing : {0.5f, 0.2f, 0.1f}) {
      const glm::vec3 towards(facing, 0.0f, std::sqrt(1.0f - facing * facing));
      const KeyRecord key = madeKey(towards, degrees * kDegree, 2.0f, kSize, 0.3f);
      const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) {
        return nearer(toPlane(ray, glm::dvec3(kUp), 0.0), toPlane(ray, glm::dvec3(kUp), -3.0));
      });
      Random<float> random(7);
      double sure = 0.0, all = 0.0;
      for (int i = 0; i < 500; ++i) {
        const glm::vec3 place(0.0f, random.number(-0.3f, 0.3f), -random.number(0.6f, 1.0f) / key.scale.x);
        const glm::vec2 visible = glsl::KeyShader{&map}.keyVisible(key, place, {1, 0, 0}, {1, 0, 0});
        sure += visible.x, all += visible.x + visible.y;
      }
      EXPECT_GT(all, 50.0) << "of 500, or the ceiling is no case; " << degrees << " degrees, cosine "
                           << facing;
      EXPECT_LT(sure, 0.05 * all) << degrees << " degrees, cosine " << facing;
    }
}

TEST(KeyLight, AWallThatLightGrazesIsLitDownToTheFloor) {
  constexpr int kSize = 512;
  for (const float degrees : {0.27f, 2.0f, 5.0f})
    for (const float facing : {0.5f, 0.3f, 0.15f, 0.1f}) {
      const glm::vec3 towards(facing, 0.0f, std::sqrt(1.0f - facing * facing));
      const KeyRecord key = madeKey(towards, degrees * kDegree, 2.0f, kSize, 0.3f);
      const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) {
        return nearer(toPlane(ray, glm::dvec3(kUp), 0.0), toBox(ray, {{-3, -3, -1}, {0, 3, 1}}));
      });
      Random<float> random(7);
      // Nearer to the floor than a quarter of a texel, the texel between both may take a little: a bias of
      // one texel is the price of walls that let no light through at their foot.
      const float foot = 0.25f / key.scale.x;
      for (int i = 0; i < 200; ++i) {
        const glm::vec3 place(0.0f, random.number(-0.3f, 0.3f),
                              random.number(foot, i % 2 == 0 ? 0.05f : 0.8f));
        ASSERT_NEAR(visibleOf(map, key, place, {1, 0, 0}, {1, 0, 0}), 1.0f, kRounding)
            << degrees << " degrees, cosine " << facing << " at " << place.z;
      }
    }
}

TEST(KeyLight, NoLightComesThroughThinWallsAndClosedRooms) {
  // Points are in a closed box of walls without thickness, on the walls and on things inside.
  constexpr int kSize = 512;
  const Slab room{{-1, -1, -1}, {1, 1, 1}};
  Random<float> random(7);
  int tried = 0;
  for (const float degrees : {0.27f, 2.0f, 8.0f})
    for (int light = 0; light < 12; ++light) {
      const glm::vec3 towards = random.direction();
      const KeyRecord key = madeKey(towards, degrees * kDegree, 2.0f, kSize, random.number(0, 3));
      const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) { return toBox(ray, room); });
      const double texel = 1.0 / double{key.scale.x};
      // The test is limited to what the map can resolve: the whole cone to the disc passes through walls that
      // the light sees, at least two texels from the room's outline, and far enough away that the receiver's
      // own plane, which rises towards the light from texel to texel, does not reach them.
      const auto wellWithin = [&](glm::vec3 place, glm::vec3 normal) {
        const double steps = 3.0 + 3.0 / std::max(double{glm::dot(normal, towards)}, 0.02);
        for (int i = 0; i < 8; ++i) {
          const double angle = 0.25 * kPi * i;
          const glm::dvec3 beside = texel * (2.0 * texel + 3.5 * double{key.scale.w}) *
                                    (std::cos(angle) * glm::dvec3(glm::vec3(key.right)) +
                                     std::sin(angle) * glm::dvec3(glm::vec3(key.up)));
          const glm::dvec3 to_light{towards};
          const double found = toBox({glm::dvec3(place) + beside + 9.0 * to_light, -to_light}, room);
          if (found < 0.0 || found > 9.0 - steps * texel) return false;
        }
        return true;
      };
      for (int i = 0; i < 500; ++i) {
        glm::vec3 place(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
        glm::vec3 normal = random.direction();
        if (i % 2 == 0) {
          const int axis = i / 2 % 3;
          const float side = i / 6 % 2 == 0 ? 1.0f : -1.0f;
          place[axis] = side;
          normal = glm::vec3(0.0f);
          normal[axis] = -side;
        }
        if (!wellWithin(place, normal)) continue;
        ++tried;
        // Rays that graze the receiver's own plane may run within a texel of it for long. That is little
        // light, in parts of what the disc gives overhead.
        const float visible = visibleOf(map, key, place, normal, normal);
        const float grazes = glm::dot(normal, towards) < 0.2f ? 3e-3f : 0.0f;
        ASSERT_LE(visible * glsl::KeyShader().keyShare(key, normal) / (key.radiance.w * key.radiance.w),
                  grazes)
            << degrees << " degrees, at " << place.x << " " << place.y << " " << place.z;
      }
    }
  EXPECT_GT(tried, 5000);
}

TEST(KeyLight, ShadowsBeginWhereABoxStands) {
  // The light comes at half height from -x, and the box's shadow falls to +x, beginning at the line of
  // contact.
  constexpr int kSize = 512;
  for (const float degrees : {0.27f, 2.0f, 5.0f, 8.0f})
    for (const float turn : {0.0f, 0.4f}) {
      const glm::vec3 towards = glm::normalize(glm::vec3(-1.0f, 0.15f, 1.0f));
      const KeyRecord key = madeKey(towards, degrees * kDegree, 2.0f, kSize, turn);
      const MadeMap map = madeMap(key, kSize, [&](const KeyRay& ray) {
        return nearer(toPlane(ray, glm::dvec3(kUp), 0.0), toBox(ray, {{-0.5, -0.5, -0.1}, {0.0, 0.5, 0.5}}));
      });
      const float texel = 1.0f / key.scale.x;
      for (int i = 0; i <= 60; ++i) {
        const float texels = 0.5f * static_cast<float>(i);
        for (const float y : {-0.2f, 0.0f, 0.013f, 0.2f}) {
          EXPECT_EQ(visibleOf(map, key, {texels * texel, y, 0.0f}, kUp, kUp), 0.0f)
              << degrees << " degrees, " << texels << " texels behind the box";
          // On the lit side the light reaches the foot of the box.
          if (texels < 2.0f) continue;
          EXPECT_NEAR(visibleOf(map, key, {-0.5f - texels * texel, y, 0.0f}, kUp, kUp), 1.0f, kRounding)
              << degrees << " degrees, " << texels << " texels before the box";
        }
      }
    }
}

TEST(KeyLight, OfADiscThatIsPartlyBelowTheHorizonTheRestShines) {
  constexpr int kSize = 256;
  const auto nothing = [](const KeyRay&) { return kMiss; };
  for (const float degrees : {2.0f, 8.0f})
    for (const float above : {-0.9f, -0.5f, 0.0f, 0.5f, 0.9f, 1.5f}) {
      const float sine = std::sin(degrees * kDegree), cosine = above * sine;
      const glm::vec3 towards(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
      const KeyRecord key = madeKey(towards, degrees * kDegree, 1.0f, kSize, 0.0f, 128);
      const MadeMap map = madeMap(key, kSize, nothing);
      // The expected value is a sum over the disc's rays above the horizon, in units of the squared sine.
      const double expected = [&] {
        constexpr int kRays = 40000;
        const glm::dvec3 right{glm::normalize(glm::vec3(key.right))}, up{glm::normalize(glm::vec3(key.up))};
        double sum = 0.0;
        for (int i = 0; i < kRays; ++i) {
          // The rays are uniform over the sphere's cap.
          const double angle = kPi * (3.0 - std::sqrt(5.0)) * i;
          const double z = 1.0 - (1.0 - std::cos(double{degrees * kDegree})) * (i + 0.5) / kRays,
                       s = std::sqrt(1.0 - z * z);
          const glm::dvec3 ray =
              s * std::cos(angle) * right + s * std::sin(angle) * up + z * glm::dvec3(towards);
          sum += std::max(ray.z, 0.0);
        }
        return 2.0 * (1.0 - std::cos(double{degrees * kDegree})) * sum / kRays;
      }();
      EXPECT_NEAR(glsl::KeyShader().keyShare(key, kUp) / (sine * sine), expected / double{sine * sine},
                  2e-3 * double{sine});
      const float all = visibleOf(map, key, glm::vec3(0.0f), kUp, kUp);
      EXPECT_NEAR(all, 1.0f, kRounding) << "the share has the horizon in it already";
      // The triangle's normal may cut off more of the disc than the shading normal; the rays give the
      // expected value.
      const glm::vec3 normal = glm::normalize(glm::vec3(-0.7f * sine, 0.0f, 1.0f));
      const double seen = visibleByRays(key, glm::vec3(0.0f), kUp, [&](const KeyRay& ray) {
        return glm::dot(ray.direction, glm::dvec3(normal)) <= 0.0;
      });
      EXPECT_NEAR(visibleOf(map, key, glm::vec3(0.0f), normal, kUp), seen, 0.03) << degrees << " " << above;
      // A triangle that faces away from the disc gets no light, for any shading normal.
      EXPECT_EQ(visibleOf(map, key, glm::vec3(0.0f), -towards, kUp), 0.0f);
    }
}

TEST(KeyLight, SharesStayBetweenNothingAndAllForDegenerateInputs) {
  Random<float> random(7);
  const auto blocks = [](const KeyRay& ray) { return toBox(ray, {{-0.3, -0.3, 0.1}, {0.3, 0.3, 0.4}}); };
  for (const int size : {8, 64})
    for (const float radius : {1e-4f, 0.1f, 0.99f})
      for (const float half : {1e-6f, 1.0f, 1e6f}) {
        const KeyRecord key = madeKey(kUp, radius, half, size);
        const MadeMap map = madeMap(key, size, blocks);
        for (const glm::vec3 normal :
             {glm::vec3(1, 0, 0), {0, 0, 1}, {0, 0, -1}, {0, 0, 0}, {1e-20f, 0, 1e-20f}})
          for (const glm::vec3 shading : {normal, glm::vec3(0, 1, 0), -normal})
            // The places include ones far beside the map, above its top and below its bottom.
            for (const glm::vec3 place :
                 {glm::vec3(0), {half, half, 0}, {1e6f, -1e6f, 0}, {0, 0, 1e6f}, {0, 0, -1e6f}}) {
              const float visible = visibleOf(map, key, place, normal, shading);
              EXPECT_TRUE(visible >= 0.0f && visible <= 1.0f + 1e-5f) << visible;
              const float share = glsl::KeyShader().keyShare(key, shading);
              EXPECT_TRUE(share >= 0.0f && share <= 1.0f) << share;
            }
      }
}

}  // namespace lambent::frame
