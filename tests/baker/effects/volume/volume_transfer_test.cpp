// Compares the transfer of volumes with closed forms (literature 7.8), and checks general properties.
#include <array>

#include <gtest/gtest.h>

#include "tests/baker/effects/volume/media.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::cube;
using testing::Fog;
using testing::gridOf;
using testing::kCenter;
using testing::kRoot4Pi;
using testing::transferOf;
using testing::uniformAt;

VolumeSettings singly(VolumeSettings settings) {
  settings.scatterings = 0;
  return settings;
}

TEST(VolumeTransfer, OfTheCubesCentreIsTheMeanTransmittance) {
  for (const auto& [sigma, wanted] : {std::pair{1.0f, 0.5445496}, {4.0f, 0.0908467}, {16.0f, 0.0001013}}) {
    const VolumeTransfer t =
        transferOf(cube(sigma), singly(gridOf(5, 5, 1024)));  // odd: a voxel in the middle
    EXPECT_NEAR(uniformAt(t, kCenter, 0) / wanted, 1.0, 2e-3) << sigma;
  }
}

// Returns the coefficients about the z axis of int tau y_l0 ds = 4 pi T_l0, for a ball of radius 1 in voxels,
// whose surface is two voxels thick.
TEST(VolumeTransfer, OfABallHasTheCoefficientsOfItsChords) {
  struct Case {
    float sigma;
    double r;
    std::array<double, 5> wanted;
  };
  const auto ball = [](float sigma) {
    return Fog(glm::uvec3(54), glm::vec3(-1.125f), glm::vec3(1.125f), [sigma](glm::vec3 p) {
      constexpr float kVoxel = 2.25f / 54.0f;  // coverage of the voxel, nearly
      return sigma * std::clamp(0.5f + (1.0f - glm::length(p)) / kVoxel, 0.0f, 1.0f);
    });
  };
  const Fog thin = ball(1.0f), thick = ball(4.0f);
  for (const Case& c : {Case{1, 0.0, {1.3040987, 0, 0, 0, 0}},
                        Case{1, 0.5, {1.4832176, .4066322, -.0063963, -.0097848, .0005781}},
                        Case{4, 0.5, {.1583801, .1333539, .0405853, .0019360, -.0017221}}}) {
    // There are nine voxels of a quarter each, and one is at each multiple of a quarter.
    const VolumeTransfer t = transferOf(c.sigma == 1.0f ? thin : thick, singly(gridOf(9)));
    for (std::size_t l = 0; l < 5; ++l)
      EXPECT_NEAR(uniformAt(t, {0, 0, c.r}, 0, l * (l + 1)) * kRoot4Pi, c.wanted[l], 6e-3 * c.wanted[0])
          << c.sigma << " " << c.r << " " << l;
  }
}

// Under uniform light from both sides, mid-depth receives E_2(tau / 2).
TEST(VolumeTransfer, OfAWideSlabIsTheExponentialIntegral) {
  for (const auto& [tau, wanted] :
       {std::pair{0.5f, 0.51773}, {1.0f, 0.32664}, {2.0f, 0.14850}, {4.0f, 0.03753}}) {
    const Fog slab({1, 1, 1}, {-500, -500, -0.5f}, {500, 500, 0.5f}, [tau](glm::vec3) { return tau; });
    VolumeSettings settings = singly(gridOf(1, 5, 4096));
    settings.grid = {1, 1, 3};
    EXPECT_NEAR(uniformAt(transferOf(slab, settings), kCenter, 0), wanted, 1e-3) << tau;
  }
}

TEST(VolumeTransfer, OfAMediumThatAbsorbsNothingIsOneEverywhereInUniformLight) {
  for (const float sigma : {1.0f, 4.0f, 16.0f}) {
    const VolumeTransfer t = transferOf(cube(sigma), gridOf(10, 1));
    ASSERT_EQ(t.grid.samples(), 1000u);
    for (std::size_t p = 0; p < t.grid.samples(); ++p)
      ASSERT_NEAR(double{t.vectors[2 * p + 1]} * kRoot4Pi, 1.0, 5e-3) << sigma << " " << p;
  }
}

// The reference is 200,000 random walks: +-0.001. The rest is the grid's error: at 16, a mean free path is
// one voxel.
TEST(VolumeTransfer, OfTheCubesCentreWithAllScatteringsIsThatOfRandomWalks) {
  struct Case {
    float sigma, albedo;
    double wanted, tolerance;
  };
  for (const Case& c :
       {Case{1, 0.5f, 0.716, 0.003}, Case{1, 0.9f, 0.930, 0.003}, Case{4, 0.5f, 0.210, 0.003},
        Case{4, 0.9f, 0.651, 0.005}, Case{16, 0.5f, 0.0007, 0.001}, Case{16, 0.9f, 0.052, 0.005}}) {
    const VolumeTransfer t = transferOf(cube(c.sigma), gridOf(17, 1, 384), glm::vec3(c.albedo));
    EXPECT_NEAR(uniformAt(t, kCenter, 1), c.wanted, c.tolerance) << c.sigma << " " << c.albedo;
  }
}

TEST(VolumeTransfer, OfNothingHasNoSamplesAndOfALumpOnlyThoseThatReachIt) {
  EXPECT_EQ(transferOf(cube(0.0f, 8), gridOf(8)).grid.samples(), 0u);
  // One voxel of sixteen: linear to its neighbours' centres, so 24/16 wide; voxels of the transfer, of the
  // same size, reach one to each side.
  const Fog lump(glm::uvec3(16), glm::vec3(0.0f), glm::vec3(16.0f),
                 [](glm::vec3 p) { return p == glm::vec3(7.5f) ? 1.0f : 0.0f; });
  const VolumeTransfer t = transferOf(lump, singly(gridOf(16, 1, 64)));
  for (const std::uint32_t v : t.grid.voxels())
    for (const std::uint32_t i : {v % 16, v / 16 % 16, v / 256})
      EXPECT_LE(std::abs(static_cast<int>(i) - 7), 2);
  EXPECT_GE(t.grid.samples(), 27u);
}

TEST(VolumeTransfer, StaysFiniteAndInRangeAtAnyOpticalDepth) {
  for (const float sigma : {1e-6f, 100.0f, 1e4f, 1e6f})
    for (const float albedo : {0.5f, 1.0f}) {
      const VolumeTransfer t = transferOf(cube(sigma), gridOf(6, 3, 256), glm::vec3(albedo));
      for (std::size_t p = 0; p < t.grid.samples(); ++p)
        for (std::size_t i = 0; i < t.vectorSize(); ++i) {
          const double value = double{t.vectors[p * t.vectorSize() + i]} * (i % 9 == 0 ? kRoot4Pi : 1.0);
          ASSERT_TRUE(std::isfinite(value)) << sigma;
          if (i % 9 == 0) {
            ASSERT_GE(value, -0.005) << sigma << " " << albedo;
            ASSERT_LE(value, 1.005) << sigma << " " << albedo;
          }
        }
      if (sigma < 1e-5f) {
        EXPECT_NEAR(uniformAt(t, kCenter, 1), 1.0, 1e-5);
      }
    }
}

// A wall is in the plane x = 0: thin fog on either side sees its half of the sky.
TEST(VolumeTransfer, CutByAWallSeesHalfTheSkyOnEachSide) {
  const testing::Transport walled(
      testing::sceneOf({testing::turned(testing::grid({0, 0, 0}, 1000.0f, 2), 90.0f, {0, 0, 1})}));
  const Occluders occluders(walled.rays, glm::mat4(1.0f));
  const VolumeTransfer t = transferOf(cube(0.01f), gridOf(8, 2), glm::vec3(1.0f), occluders);
  const std::size_t x = 3;  // y_11
  for (const double side : {-0.3, 0.3}) {
    EXPECT_NEAR(uniformAt(t, {side, 0, 0}, 0), 0.5, 0.01);
    EXPECT_NEAR(uniformAt(t, {side, 0, 0}, 0, x) / kRoot4Pi, std::copysign(0.4886025 / 4.0, side), 0.003);
    EXPECT_LT(uniformAt(t, {side, 0, 0}, 1), 0.52);  // and scattering does not light through it
  }
}

TEST(VolumeTransfer, InsideAClosedMeshIsDark) {
  const testing::Transport closed(testing::sceneOf({testing::icosphere({0, 0, 0}, 3.0f, 2)}));
  const VolumeTransfer t =
      transferOf(cube(4.0f), gridOf(5, 3, 256), glm::vec3(1.0f), Occluders(closed.rays, glm::mat4(1.0f)));
  ASSERT_GT(t.grid.samples(), 0u);
  for (const float value : t.vectors) ASSERT_NEAR(value, 0.0f, 1e-6f);
}

}  // namespace
}  // namespace lambent::baker
