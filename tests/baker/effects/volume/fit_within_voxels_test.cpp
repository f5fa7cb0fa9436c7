// Tests transfer grids that are too coarse for their medium.
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "baker/effects/volume/scattering.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "runtime/sh/basis.hpp"
#include "tests/baker/effects/volume/media.hpp"

namespace lambent::baker {

namespace {

using testing::cube;
using testing::Fog;
using testing::gridOf;
using testing::kRoot4Pi;
using testing::transferOf;

// Returns a uniformly distributed place in the cube.
glm::vec3 placeOf(int k) {
  return glm::fract(static_cast<float>(k) * glm::vec3(0.8191725f, 0.6710436f, 0.5497005f)) - 0.5f;
}

TEST(GridFit, FindsWhatTheGridCanShowAndLeavesAloneWhatNoPlaceIsNear) {
  const Fog fog = cube(1.0f);
  const TransferGrid grid(*fog.field, fog.values, glm::uvec3(6));
  const auto plane = [](const glm::vec3& p) { return 2.0f - p.x + 3.0f * p.y + 0.5f * p.z; };
  std::vector<float> samples(2 * grid.samples(), 7.0f);
  GridFit fit(grid, 2, samples);
  for (int k = 0; k < 3000; ++k)
    if (glm::vec3 p = placeOf(k); p.x < 0.0f) {
      // In the half voxels at the faces, interpolation is constant.
      p = glm::clamp(p, glm::vec3(-5.0f / 12.0f), glm::vec3(5.0f / 12.0f));
      fit.add(p, 1.0 + p.y, std::array{plane(p), 7.0f});
    }
  const std::vector<float> change = fit.solve();
  for (std::size_t q = 0; q < grid.samples(); ++q) {
    const glm::vec3 p = grid.place(q);
    // Of 5: what comes in holds a little.
    if (p.x < -0.1f) {
      EXPECT_NEAR(7.0f + change[2 * q], plane(p), 0.15f);
    }
    if (p.x > 0.1f) {
      EXPECT_EQ(change[2 * q], 0.0f);
    }
    EXPECT_NEAR(change[2 * q + 1], 0.0f, 1e-5f);
  }
}

// Computes the single-scattered light that leaves a cube of optical depth 16, on a grid of 8 (two mean free
// paths per voxel), and compares it with fine steps and independent rays.
TEST(FitWithinVoxels, BringsWhatGoesOutOfAMediumOfShortFreePathsNearer) {
  constexpr float kSigma = 16.0f;
  const Fog fog = cube(kSigma);
  const SphereTable rays(1024, 2);
  const Occluders none;
  FirstLight first(*fog.field, none);
  std::array<double, 2> wrong{}, bias{};
  for (const bool fitted : {false, true}) {
    VolumeSettings settings = gridOf(8, 2, 1024);
    settings.scatterings = 0;
    settings.fit_within_voxels = fitted;
    const VolumeTransfer volume = transferOf(fog, settings);
    for (int k = 0; k < 30; ++k) {
      const glm::vec3 enters = glm::vec3(0.9f, 0.9f, 0.0f) * placeOf(k) + glm::vec3(0.0f, 0.0f, 0.5f);
      const glm::vec3 along = glm::normalize(glm::vec3(0.3f, -0.2f, -1.0f));
      double light = 0.0;
      constexpr int kSteps = 40;
      constexpr double kStep = 8.0 / kSteps;  // of optical depth
      for (int step = 0; step < kSteps; ++step) {
        const double depth = (step + 0.5) * kStep;
        std::array<float, 4> arrives;
        first.look(enters + static_cast<float>(depth / double{kSigma}) * along, rays, arrives);
        light += std::exp(-depth) * kStep * double{arrives[0]} * kRoot4Pi;
      }
      std::array<float, 12> scattered;
      marchVolume(volume, enters - along, along, 100.0f, scattered);
      const double error = double{scattered[0]} * kRoot4Pi / light - 1.0;
      wrong[fitted] += error * error / 30.0, bias[fitted] += error / 30.0;
    }
  }
  EXPECT_LT(wrong[1], 0.6 * wrong[0]) << wrong[0];
  EXPECT_LT(std::abs(bias[1]), 0.5 * std::abs(bias[0])) << bias[0];
}

TEST(FitWithinVoxels, LeavesThinMediaAlone) {
  const Fog fog = cube(2.0f);
  VolumeSettings settings = gridOf(9, 2, 256);
  const std::vector<float> before = transferOf(fog, settings).vectors;
  settings.fit_within_voxels = true;
  EXPECT_EQ(transferOf(fog, settings).vectors, before);
}

// Tests a baked volume as other groups see it.

using testing::cube;
using testing::transferOf;

VolumeSettings coarse() {
  VolumeSettings settings;
  settings.order = 2;
  settings.rays = 256;
  settings.grid = glm::uvec3(8);
  return settings;
}

TEST(MarchedVolume, ThatAbsorbsNothingIsNotSeenInUniformLightWhateverItsPhase) {
  for (const float g : {0.0f, 0.5f, -0.7f}) {
    const VolumeTransfer volume = transferOf(cube(4.0f), coarse(), glm::vec3(1.0f), {}, g);
    const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, 0.2f, -0.4f));
    for (const glm::vec3& origin : {glm::vec3(0.0f), glm::vec3(-2.0f, -0.3f, 0.7f), glm::vec3(0.45f)}) {
      std::array<float, 12> scattered;
      const float clear = marchVolume(volume, origin, direction, 100.0f, scattered);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(clear + scattered[4 * c] * std::sqrt(4.0f * std::numbers::pi_v<float>), 1.0f, 5e-3f);
    }
  }
}

// Along a chord of depth d, a thin volume adds d sum_i g^l(i) l_i y_i(direction) of the light l. With g > 0
// this is more for light that travels towards the eye.
TEST(MarchedVolume, ThatIsThinScattersWhatComesFromBehindItByItsPhase) {
  constexpr float kSigma = 1e-3f, kG = 0.6f;
  const VolumeTransfer volume = transferOf(cube(kSigma), coarse(), glm::vec3(0.5f), {}, kG);
  const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, 0.0f, 0.5f));
  std::array<float, 12> scattered;
  marchVolume(volume, -2.0f * direction, direction, 100.0f, scattered);
  const float chord = std::sqrt(1.25f);
  std::array<float, 4> y;
  sh::evaluate(2, direction, std::span<float>(y));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(scattered[i] / (0.5f * kSigma * chord), y[i] * (i == 0 ? 1.0f : kG), 3e-3f) << i;
}

TEST(MarchedVolume, LetsThroughWhatTheChordLetsThrough) {
  const VolumeTransfer volume = transferOf(cube(2.0f), coarse(), glm::vec3(0.5f, 0.25f, 0.0f));
  std::array<float, 12> scattered;
  EXPECT_NEAR(marchVolume(volume, {-3, 0, 0}, {1, 0, 0}, 100.0f, scattered), std::exp(-2.0f), 1e-4f);
  EXPECT_GT(scattered[0], scattered[4]);
  EXPECT_GT(scattered[4], 0.0f);
  EXPECT_EQ(scattered[8], 0.0f);  // blue scatters nothing
  EXPECT_NEAR(marchVolume(volume, {-3, 0, 0}, {1, 0, 0}, 2.75f, scattered), std::exp(-0.5f), 1e-4f);
}

TEST(MarchedVolume, ThatIsEmptyIsInvisibleToTheLastBit) {
  const VolumeTransfer volume = transferOf(cube(0.0f, 4), coarse());
  std::array<float, 12> scattered;
  EXPECT_EQ(marchVolume(volume, {-3, 0, 0}, {1, 0, 0}, 100.0f, scattered), 1.0f);
  for (const float value : scattered) EXPECT_EQ(value, 0.0f);
}

}  // namespace
}  // namespace lambent::baker
