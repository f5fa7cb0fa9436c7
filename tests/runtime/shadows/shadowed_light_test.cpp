// Compares unoccluded local lights, and the visibility by their shadow cubes, with closed forms
// and with quadrature that does not use these formulas.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "tests/runtime/shadows/random.hpp"
#include "tests/runtime/shadows/shadow_shaders.hpp"

namespace lambent::frame {
namespace {

using sh::kPi;
using testing::Random;

// The shader's functions are members of the tests.
struct ShadowedLight : ::testing::Test, glsl::LocalShader {};
using LocalShadow = ShadowedLight;

// Returns (1/pi) times the integral of the clamped cosine over a cone about +Z, with the normal tilted in the
// xz plane.
double coneShare(double normal_cosine, double cone_sine) {
  const double normal_sine = std::sqrt(1.0 - normal_cosine * normal_cosine);
  constexpr int kRings = 600, kTurns = 600;
  const double least = std::sqrt(1.0 - cone_sine * cone_sine);
  double sum = 0.0;
  for (int i = 0; i < kRings; ++i) {
    const double z = least + (1.0 - least) * (i + 0.5) / kRings, sine = std::sqrt(1.0 - z * z);
    for (int j = 0; j < kTurns; ++j)
      sum += std::max(normal_cosine * z + normal_sine * sine * std::cos(2.0 * kPi * (j + 0.5) / kTurns), 0.0);
  }
  return sum * 2.0 * kPi * (1.0 - least) / (kRings * kTurns) / kPi;
}

// Returns the same for a disc, by points on its area.
double discSum(glm::dvec3 normal, glm::dvec3 to_light, glm::dvec3 direction, double radius) {
  glm::vec3 s, t;
  glsl::LocalShader().localBasis(glm::vec3(direction), s, t);
  constexpr int kRings = 500, kTurns = 500;
  double sum = 0.0;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kTurns; ++j) {
      const double rho = radius * std::sqrt((i + 0.5) / kRings), angle = 2.0 * kPi * (j + 0.5) / kTurns;
      const glm::dvec3 ray =
          to_light + rho * (std::cos(angle) * glm::dvec3(s) + std::sin(angle) * glm::dvec3(t));
      const double squared = glm::dot(ray, ray);
      sum += std::max(glm::dot(normal, ray), 0.0) * std::max(-glm::dot(direction, ray), 0.0) /
             (squared * squared);
    }
  return sum * radius * radius / (kRings * kTurns);  // pi of the area against 1/pi
}

ShadowedLightRecord lightOf(uint kind) {
  return {.position = glm::vec3(0.0f),
          .reach = 100.0f,
          .direction = {0, 0, -1},
          .kind = kind,
          .power = glm::vec3(1.0f),
          .radius = 0.0f,
          .cos_outer = 0.0f,
          .cone_scale = 1.0f,
          .range = 0.0f,
          .pad = 0.0f};
}

}  // namespace

TEST_F(ShadowedLight, ASphereGivesWhatAQuadratureOfItsConeGivesAlsoAcrossTheHorizon) {
  for (const float h : {1.01f, 1.3f, 2.0f, 5.0f, 20.0f, 63.0f, 65.0f, 500.0f})
    // The heights go from below the horizon to above it in steps of the sphere's size, and to straight above.
    for (const double above : {-1.2, -0.9, -0.5, -0.1, 0.0, 0.3, 0.7, 0.99, 1.0, 1.5, 1e9}) {
      const double cosine = std::clamp(above / double{h}, -1.0, 1.0);
      const double expected = coneShare(cosine, 1.0 / double{h});
      // The quadrature's error is 1e-5 of the largest result, and so is that of the cancellation.
      EXPECT_NEAR(sphereShare(static_cast<float>(cosine), h), expected, 2e-4 / (h * h) + 2e-3 * expected)
          << "h " << h << " above " << above;
    }
}

TEST_F(ShadowedLight, ADiscGivesWhatAQuadratureOfItsAreaGivesAlsoAcrossTheHorizon) {
  Random<float> random(11);
  for (int i = 0; i < 40; ++i) {
    const glm::vec3 normal = random.direction(), direction = random.direction();
    const glm::vec3 to_light = random.number(0.5f, 3.0f) * random.direction();
    const float radius = random.number(0.05f, 1.0f);
    const double expected = discSum(normal, to_light, direction, radius);
    const bool shines = glm::dot(direction, to_light) < 0.0f;
    // A polygon of 24 corners replaces the circle.
    EXPECT_NEAR(discShare(normal, to_light, direction, radius), shines ? expected : 0.0,
                3e-3 * expected + 1e-4);
  }
}

TEST_F(ShadowedLight, ADiscOverheadHasItsKnownFormFactor) {
  // A point on the disc's axis that faces it gets r^2 / (r^2 + d^2).
  for (const float radius : {0.01f, 0.049f, 0.051f, 0.3f, 1.0f, 10.0f, 1000.0f}) {
    const float expected = radius * radius / (radius * radius + 1.0f);
    EXPECT_NEAR(discShare({0, 1, 0}, {0, 1, 0}, {0, -1, 0}, radius), expected, 3e-3f * expected);
  }
  EXPECT_EQ(discShare({0, 1, 0}, {0, 1, 0}, {0, 1, 0}, 0.5f), 0.0f) << "it shines to one side";
}

TEST_F(ShadowedLight, PunctualLightsFadeAsTheirExtensionSays) {
  ShadowedLightRecord point = lightOf(kLocalPoint);
  EXPECT_NEAR(localShare(point, {0, 0, 1}, {0, 0, 2}), 0.25 / kPi, 1e-7);
  EXPECT_NEAR(localShare(point, {0, 0, 1}, {0, 3, 4}), 0.8 / 25.0 / kPi, 1e-7);
  EXPECT_EQ(localShare(point, {0, 0, 1}, {0, 0, -2}), 0.0f);
  point.range = 4.0f;
  EXPECT_NEAR(punctualShare(point, {0, 0, 2}), 0.25 * (1.0 - 1.0 / 16.0), 1e-7);
  EXPECT_EQ(punctualShare(point, {0, 0, 5}), 0.0f);
  ShadowedLightRecord spot = lightOf(kLocalSpot);
  const float inner = std::cos(0.2f), outer = std::cos(0.5f);
  spot.cos_outer = outer;
  spot.cone_scale = 1.0f / (inner - outer);
  const auto at = [&](float angle) {  // from the axis, one metre away
    return punctualShare(spot, {std::sin(angle), 0.0f, std::cos(angle)});
  };
  EXPECT_NEAR(at(0.1f), 1.0f, 1e-6f);
  EXPECT_EQ(at(0.6f), 0.0f);
  const float half = (std::cos(0.4f) - outer) / (inner - outer);
  EXPECT_NEAR(at(0.4f), half * half, 1e-5f);
}

TEST_F(LocalShadow, EveryDirectionFindsItsTexel) {
  Random<float> random(11);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 direction = random.direction();
    const int face = shadowFace(direction), size = 64;
    distance_at = [&](int f, glm::ivec2 texel) {
      EXPECT_EQ(f, face);
      EXPECT_TRUE(texel.x >= 0 && texel.y >= 0 && texel.x < size && texel.y < size);
      return 1.0f;
    };
    const Blocker blocker = blockerAt(0, direction, size);
    EXPECT_GT(glm::dot(blocker.direction, direction), std::cos(0.75f * 2.0f / 64.0f));
  }
}

TEST_F(LocalShadow, FacesAreDrawnWhereTheyAreLookedUp) {
  for (std::uint32_t face = 0; face < 6; ++face) {
    const FaceAxes axes = faceAxes(face);
    const int i = static_cast<int>(face);
    EXPECT_EQ(axes.forward, faceForward(i));
    EXPECT_EQ(axes.up, faceUp(i));
    EXPECT_EQ(axes.right, faceRight(i));
    EXPECT_EQ(glm::cross(axes.right, axes.up), -axes.forward) << "as a camera sees";
  }
}

TEST_F(LocalShadow, BoxesMeetTheFacesThatTheirPointsFall) {
  Random<float> random(11);
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 center = 2.0f * random.direction(), half(random.number(0.01f, 1.0f));
    const scene::Box box{.min = center - half, .max = center + half};
    for (int j = 0; j < 20; ++j) {
      const glm::vec3 point =
          center + half * glm::vec3(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
      EXPECT_TRUE(faceMeets(faceAxes(static_cast<std::uint32_t>(shadowFace(point))), box));
      EXPECT_GE(glm::length(point), nearestDistance(box) - 1e-6f);
      EXPECT_LE(glm::length(point), farthestDistance(box) + 1e-6f);
    }
  }
}

TEST_F(LocalShadow, APlaneThatLightGrazesIsLitAndABlockerShadowsIt) {
  // A floor is 0.05 below the light; each texel sees the floor, out to the horizon.
  const auto floor_only = [this](int face, glm::ivec2 texel) {
    const glm::vec3 direction = texelDirection(face, glm::vec2(texel) + 0.5f, 512);
    return direction.y < 0.0f ? -0.05f / direction.y : kNothing;
  };
  // A wall at x = 1 is on it, 0.5 high: the floor behind is dark.
  const auto with_wall = [&](int face, glm::ivec2 texel) {
    const glm::vec3 direction = texelDirection(face, glm::vec2(texel) + 0.5f, 512);
    const float wall = direction.x > 0.0f ? 1.0f / direction.x : kNothing;
    return direction.y * wall < 0.45f ? std::min(wall, floor_only(face, texel)) : floor_only(face, texel);
  };
  constexpr float kRounding = 1e-5f;  // weights of four texels sum to 1 but for that
  Random<float> random(11);
  ShadowedLightRecord sphere = lightOf(kLocalSphere);
  sphere.radius = 0.02f;
  const glm::vec3 up(0, 1, 0);
  for (int i = 0; i < 2000; ++i) {
    const float x = random.number(-4, 4), z = random.number(-1, 1), turns = random.number(0, 1);
    const glm::vec3 place(x, -0.05f, z);
    const ShadowReceiver receiver = shadowReceiver(place, up, up, 512);
    distance_at = floor_only;
    EXPECT_NEAR(pointVisible(0, receiver, 512), 1.0f, kRounding);
    EXPECT_NEAR(discVisible(0, sphere, receiver, up, 512, 16, turns), 1.0f, kRounding);
    distance_at = with_wall;
    // Before the wall it is light up to the foot. Behind it, a point's shadow begins within 1 % of the
    // distance and a sphere's within 6 %.
    const bool before = x < 0.98f;
    if (before || x > 1.012f * 1.02f) {
      EXPECT_NEAR(pointVisible(0, receiver, 512), before ? 1.0f : 0.0f, kRounding) << x << " " << z;
    }
    if (before || x > 1.06f) {
      EXPECT_NEAR(discVisible(0, sphere, receiver, up, 512, 16, turns), before ? 1.0f : 0.0f, kRounding)
          << x << " " << z;
    }
  }
}

// The walls stand at one distance from the light at their nearest, and at much more at their farthest, as
// those of a lamp's shade do. Seen from a point outside, they are steep in places.
TEST_F(LocalShadow, ALampInAClosedShellLightsNothingOutsideOfIt) {
  constexpr float kWall = 0.4f;
  const auto box = [](glm::vec3 d) {
    return kWall / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  };
  const auto flat = [](glm::vec3 d) { return kWall / glm::length(glm::vec3(d.x, d.y / 0.5f, d.z)); };
  const auto bumpy = [](glm::vec3 d) {
    return kWall * (1.0f + 0.25f * std::sin(5.0f * d.x) * std::cos(7.0f * d.y + 1.0f));
  };
  const std::array<float (*)(glm::vec3), 3> shells = {box, flat, bumpy};
  constexpr int kSize = 512, kPlaces = 1000;
  Random<float> random(11);
  ShadowedLightRecord sphere = lightOf(kLocalSphere);
  for (std::size_t shell = 0; shell < shells.size(); ++shell) {
    distance_at = [&](int face, glm::ivec2 texel) {
      return shells[shell](texelDirection(face, glm::vec2(texel) + 0.5f, kSize));
    };
    for (const float radius : {0.05f, 0.1f, 0.15f}) {
      sphere.radius = radius;
      for (int i = 0; i < kPlaces; ++i) {
        const glm::vec3 towards = random.direction();
        const glm::vec3 place = random.number(0.9f, 4.0f) * towards;
        const glm::vec3 normal = glm::normalize(-towards + 0.8f * random.direction());
        const ShadowReceiver receiver = shadowReceiver(place, normal, normal, kSize);
        EXPECT_EQ(discVisible(0, sphere, receiver, normal, kSize, 16, random.number(0, 1)), 0.0f)
            << "shell " << shell << ", radius " << radius << ", place " << place.x << " " << place.y << " "
            << place.z;
      }
    }
  }
}

}  // namespace lambent::frame
