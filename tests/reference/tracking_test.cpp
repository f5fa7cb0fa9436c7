// Compares random walks through media with integrals along the ray.
#include <array>

#include <gtest/gtest.h>

#include "reference/camera.hpp"
#include "reference/sampler.hpp"
#include "reference/volumes.hpp"
#include "tests/reference/media.hpp"

namespace lambent::baker::reference {

namespace {

using testing::even;
using testing::medium;
using testing::place;
using testing::sceneOf;
using testing::volumesOf;

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Estimate {
  double mean = 0.0, error = 0.0;
};

template <typename Draw>
Estimate estimated(int count, const Draw& draw) {
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < count; ++i) {
    Stream random = Sampler(7, 1, 0).stream(2, static_cast<std::uint32_t>(i), 3);
    const double value = draw(random);
    sum += value, squares += value * value;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / count)};
}

// Compares both trackers with the expected transmittance.
void expectTransmittance(const Volumes& volumes, const Ray& ray, double far, double expected) {
  constexpr int kCount = 40000;
  const Estimate ratio = estimated(kCount, [&](Stream& r) { return volumes.transmittance(ray, far, r); });
  EXPECT_NEAR(ratio.mean, expected, 4.0 * ratio.error + 1e-6);
  const Estimate delta =
      estimated(kCount, [&](Stream& r) { return volumes.collide(ray, far, r) ? 0.0 : 1.0; });
  EXPECT_NEAR(delta.mean, expected, 4.0 * delta.error + 1e-6);
  EXPECT_LE(ratio.error, delta.error * 1.02 + 1e-9) << "a ratio knows more than a hit";
}

const glm::mat4 kWildNode =
    glm::rotate(glm::translate(glm::mat4(1), {0.2f, -0.1f, 0.3f}), 0.7f, glm::vec3(0.3f, 1, 0.2f));

// Makes an irregular field of 21 x 10 x 17 voxels, partly empty, whose blocks differ.
Scene wild() {
  Scene scene = sceneOf({});
  std::uint32_t state = 1;
  SceneVolume volume = medium({21, 10, 17}, [&](glm::vec3 p) {
    state = hash32(state);
    return p.x < 6.0f ? 0.0f : 3.0f * unitFloat(state) * (p.z > 9.0f ? 5.0f : 0.2f);
  });
  volume.node_from_grid = glm::scale(glm::mat4(1), glm::vec3(0.05f, 0.1f, 0.06f));
  place(scene, volume, kWildNode);
  return scene;
}

// Lists rays through its box of 1.05 x 1 x 1.02 metres: along two diagonals, nearly along an axis, and from
// inside.
std::vector<Ray> raysThroughWild() {
  const auto ray = [](glm::vec3 from, glm::vec3 to, float length) {
    const glm::vec3 a(kWildNode * glm::vec4(from, 1)), b(kWildNode * glm::vec4(to, 1));
    return Ray{a, length * glm::normalize(b - a), 0};
  };
  return {ray({-0.5f, -0.4f, -0.3f}, {1, 0.9f, 1}, 1), ray({1.9f, 1.5f, 1.7f}, {0.4f, 0.2f, 0.1f}, 3),
          ray({0.7f, 3, 0.4f}, {0.7f, -1, 0.5f}, 0.2f), ray({0.6f, 0.3f, 0.5f}, {0.8f, 0.4f, 1}, 1)};
}

TEST(GridMedium, IsLinearBetweenCentresAndConstantInTheHalfVoxelAtTheFaces) {
  const SceneVolume volume = medium({3, 2, 1}, [](glm::vec3 p) { return p.x * 10 + p.y; });
  const GridMedium grid(volume, glm::dmat4(1.0));
  EXPECT_FLOAT_EQ(grid.at({0.5, 0.5, 0.5}), 5.5f);
  EXPECT_FLOAT_EQ(grid.at({1.0, 0.5, 0.1}), 10.5f);
  EXPECT_FLOAT_EQ(grid.at({1.25, 1.0, 0.9}), 13.5f);
  EXPECT_FLOAT_EQ(grid.at({0.0, 0.0, 0.0}), 5.5f);
  EXPECT_FLOAT_EQ(grid.at({2.5, 1.5, 0.5}), 26.5f);
  EXPECT_FLOAT_EQ(grid.at({3.0, 2.0, 1.0}), 26.5f);
  EXPECT_FALSE(grid.clipped({{-1, 2.001f, 0.5f}, {1, 0, 0}, 0}, 0.0, kFar));
  const auto inside = grid.clipped({{-1, 1, 0.5f}, {2, 0, 0}, 0}, 0.0, 1.0);
  ASSERT_TRUE(inside);
  EXPECT_DOUBLE_EQ(inside->begin, 0.5);
  EXPECT_DOUBLE_EQ(inside->end, 1.0);
  EXPECT_DOUBLE_EQ(inside->metres, 2.0);
}

TEST(EyeDepth, IsTheIntegralOfTheDensityAlongTheRay) {
  const Scene scene = wild();
  const Volumes volumes = volumesOf(scene);
  for (const Ray& ray : raysThroughWild()) {
    const EyeDepth eye(volumes, ray, 0.0, kFar);
    const auto inside = volumes.grids()[0].clipped(ray, 0.0, kFar);
    ASSERT_TRUE(inside);
    double sum = 0.0;
    constexpr int kSteps = 400000;
    for (int i = 0; i < kSteps; ++i) {
      const double share = (i + 0.5) / kSteps, step = (inside->end - inside->begin) / kSteps;
      sum +=
          double{volumes.grids()[0].at(inside->at(inside->begin + share * (inside->end - inside->begin)))} *
          inside->metres * step;
      if (i == kSteps / 3) {
        EXPECT_NEAR(eye.to(inside->begin + (share + 0.5 / kSteps) * (inside->end - inside->begin)), sum,
                    2e-5);
      }
    }
    EXPECT_NEAR(eye.to(kFar), sum, 2e-5);
    EXPECT_EQ(eye.to(inside->begin), 0.0);
    // place() is the inverse of to().
    for (const double share : {1e-9, 0.01, 0.3, 0.77, 1.0})
      EXPECT_NEAR(eye.to(eye.place(share * sum)), share * sum, 1e-6 * sum + 1e-6) << share;
  }
}

TEST(Tracking, ThroughAWildFieldIsUnbiased) {
  const Scene scene = wild();
  const Volumes volumes = volumesOf(scene);
  for (const Ray& ray : raysThroughWild()) {
    const EyeDepth eye(volumes, ray, 0.0, kFar);
    expectTransmittance(volumes, ray, kFar, std::exp(-eye.to(kFar)));
    const double middle = eye.place(0.4 * eye.to(kFar));
    expectTransmittance(volumes, ray, middle, std::exp(-eye.to(middle)));
  }
}

TEST(Tracking, MeetsWhereTheExtinctionIs) {
  // Quartiles of the first collision's depth, of those that collide.
  const Scene scene = wild();
  const Volumes volumes = volumesOf(scene);
  const Ray ray = raysThroughWild()[0];
  const EyeDepth eye(volumes, ray, 0.0, kFar);
  const double share = -std::expm1(-eye.to(kFar));
  for (const double quantile : {0.25, 0.5, 0.75}) {
    const double t = eye.place(-std::log1p(-quantile * share));
    const Estimate before = estimated(40000, [&](Stream& r) {
      const auto met = volumes.collide(ray, kFar, r);
      return met && met->t < t ? 1.0 : 0.0;
    });
    EXPECT_NEAR(before.mean, quantile * share, 4.0 * before.error);
  }
}

TEST(Tracking, CountsMetresOfTheWorldWhateverTheNodesScaleAndTheRaysLength) {
  Scene scene = sceneOf({});
  place(scene, even(2.0f), glm::scale(glm::mat4(1), {3, 1, 0.5f}));
  const Volumes volumes = volumesOf(scene);
  EXPECT_NEAR(EyeDepth(volumes, {{-5, 0, 0}, {1, 0, 0}, 0}, 0.0, kFar).to(kFar), 6.0, 1e-5);
  EXPECT_NEAR(EyeDepth(volumes, {{0, 0, 9}, {0, 0, -40}, 0}, 0.0, kFar).to(kFar), 1.0, 1e-5);
  EXPECT_NEAR(EyeDepth(volumes, {{0, 0, 0}, {0, 0, -40}, 0}, -1.0, kFar).to(kFar), 1.0, 1e-5);
  expectTransmittance(volumes, {{0, 0, 9}, {0, 0, -40}, 0}, kFar, std::exp(-1.0));
}

TEST(Tracking, InASphereLetsThroughWhatTheTableSays) {
  // The values are from literature 7.8, for radius 1. Voxels at the rim have the fraction that lies inside.
  const auto ball = medium({64, 64, 64}, [](glm::vec3 p) {
    int inside = 0;
    for (int k = 0; k < 64; ++k) {
      const glm::vec3 at = (p - 32.0f + (glm::vec3(k % 4, k / 4 % 4, k / 16) - 1.5f) / 4.0f) / 31.0f;
      inside += glm::dot(at, at) < 1.0f;
    }
    return static_cast<float>(inside) / 64.0f;
  });
  const double expected[][3] = {{1, 0, .36787944},  {1, .5, .41840795}, {1, .9, .58995175},
                                {4, .5, .04467820}, {4, .9, .25201355}, {16, .9, .03717905}};
  for (const auto& [sigma, radius, mean] : expected) {
    SceneVolume volume = ball;
    for (float& density : volume.density) density *= static_cast<float>(sigma);
    volume.node_from_grid =
        glm::translate(glm::scale(glm::mat4(1), glm::vec3(1.0f / 31.0f)), glm::vec3(-32.0f));
    Scene scene = sceneOf({});
    place(scene, volume);
    const Volumes volumes = volumesOf(scene);
    double sum = 0.0;
    constexpr int kCount = 4000;
    for (int i = 0; i < kCount; ++i) {
      const Ray ray{glm::vec3(0, radius, 0), glm::vec3(testing::evenDirection(i, kCount)), 0};
      sum += std::exp(-EyeDepth(volumes, ray, 0.0, kFar).to(kFar)) / kCount;
    }
    // The rim is as soft as a voxel, 1/31 of the radius. The error is of its square and of the density.
    EXPECT_NEAR(sum, mean, 0.002 * mean * (1.0 + sigma)) << sigma << " " << radius;
  }
}

TEST(Tracking, StaysWithinZeroAndOneForAnyDensity) {
  for (const float density : {1e-30f, 1e-6f, 1e6f, 1e30f}) {
    Scene scene = sceneOf({});
    place(scene, even(density));
    const Volumes volumes = volumesOf(scene);
    const Ray ray{{-1, 0.1f, 0.2f}, {1, 0, 0}, 0};
    for (std::uint32_t i = 0; i < 100; ++i) {
      Stream random = Sampler(0, 0, 0).stream(0, i, 0);
      const double through = volumes.transmittance(ray, kFar, random);
      EXPECT_TRUE(through >= 0.0 && through <= 1.0);
      const auto met = volumes.collide(ray, kFar, random);
      EXPECT_EQ(met.has_value(), density > 1.0f);
      // A voxel stands for at most 256 free paths, however dense it is (volumes.cpp); no path here is ten
      // long.
      if (met) {
        EXPECT_TRUE(met->t >= 0.5 && met->t < 0.505) << met->t;
      }
    }
    // Four voxels are crossed, which let nothing through at their limit of 256 free paths each.
    EXPECT_NEAR(EyeDepth(volumes, ray, 0.0, kFar).to(kFar) / std::min(double{density}, 4 * 256.0), 1.0, 1e-5);
  }
}

TEST(Phase, DrawsDirectionsByItsValue) {
  // Compares frequencies of the cosine in twenty bins; azimuths must be uniform.
  constexpr int kCount = 1 << 18, kBins = 20;
  const glm::vec3 along = glm::normalize(glm::vec3(0.3f, -0.5f, 0.8f));
  const glm::mat3 frame = frameAbout(along);
  for (const float g : {-0.7f, -1e-5f, 0.0f, 5e-5f, 2e-4f, 0.4f, 0.85f}) {
    std::array<double, kBins> shares{};
    glm::dvec3 mean(0.0);
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const glm::vec3 dir = samplePhase(g, along, Sampler(3, 0, 0).pair(0, i));
      ASSERT_NEAR(glm::length(dir), 1.0f, 1e-6f);
      const float cosine = glm::dot(dir, along);
      shares[static_cast<std::size_t>(std::clamp((cosine + 1.0f) * 0.5f * kBins, 0.0f, kBins - 1.0f))] +=
          1.0 / kCount;
      mean += glm::dvec3(dir * frame) / double{kCount};
    }
    EXPECT_NEAR(mean.z, double{g}, 1e-4) << g;
    EXPECT_NEAR(mean.x, 0.0, 1e-3) << g;
    EXPECT_NEAR(mean.y, 0.0, 1e-3) << g;
    for (int b = 0; b < kBins; ++b) {
      double expected = 0.0;
      for (int i = 0; i < 1000; ++i) {
        const double c = -1.0 + (b + (i + 0.5) / 1000) * 2.0 / kBins;
        expected +=
            2.0 * std::numbers::pi * 2.0 / kBins * double{phaseValue(g, static_cast<float>(c))} / 1000;
      }
      EXPECT_NEAR(shares[static_cast<std::size_t>(b)], expected, 2e-4) << g << " " << b;
    }
  }
}

TEST(Phase, StaysFiniteWhereItIsSharpest) {
  for (const float g : {std::nextafter(1.0f, 0.0f), std::nextafter(-1.0f, 0.0f)})
    for (const glm::vec2 u : {glm::vec2(0, 0), glm::vec2(0.5f), glm::vec2(std::nextafter(1.0f, 0.0f))}) {
      const glm::vec3 dir = samplePhase(g, {0, 0, 1}, u);
      EXPECT_NEAR(glm::length(dir), 1.0f, 1e-5f);
      EXPECT_TRUE(std::isfinite(phaseValue(g, dir.z)) && phaseValue(g, dir.z) > 0.0f);
    }
}

}  // namespace
}  // namespace lambent::baker::reference
