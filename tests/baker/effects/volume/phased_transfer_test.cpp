// Tests the transfer of volumes that scatter mostly forwards or backwards.
#include <array>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "baker/effects/volume/volume_rays.hpp"
#include "baker/import/density_file.hpp"
#include "baker/jobs/parallel.hpp"
#include "reference/volumes.hpp"
#include "runtime/sh/basis.hpp"
#include "tests/baker/effects/volume/media.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::arrivingAt;
using testing::cube;
using testing::Fog;
using testing::gridOf;
using testing::kCenter;
using testing::kRoot4Pi;
using testing::transferOf;

VolumeTransfer phased(const Fog& fog, const VolumeSettings& settings, float g, float albedo = 1.0f) {
  return transferOf(fog, settings, glm::vec3(albedo), {}, g);
}

TEST(PhasedTransfer, HasAsManyBandsAsThePhaseNeeds) {
  EXPECT_EQ(bandsOfPhase(0.0f, 5), 1);
  EXPECT_EQ(bandsOfPhase(-0.5f, 5), 3);
  EXPECT_EQ(bandsOfPhase(0.6f, 5), 5);
  EXPECT_EQ(bandsOfPhase(-0.6f, 4), 4);
  EXPECT_EQ(bandsOfPhase(0.9f, 3), 3);
}

TEST(PhasedTransfer, OfAMediumThatAbsorbsNothingIsUniformEverywhereInUniformLight) {
  for (const float g : {0.5f, -0.3f, 0.8f})
    for (const float sigma : {1.0f, 4.0f, 16.0f}) {
      const VolumeTransfer t = phased(cube(sigma), gridOf(8, g == 0.8f ? 4 : 1, 256), g);
      ASSERT_EQ(t.outputs(), g == 0.8f ? 16u : 9u);
      double worst = 0.0;
      for (std::size_t p = 0; p < t.grid.samples(); ++p)
        for (std::size_t i = 0; i < t.outputs(); ++i) {
          const float* full = &t.vectors[p * t.vectorSize() + t.outputs() * t.columns()];
          worst = testing::larger(worst, std::abs(double{full[i * t.columns()]} - (i == 0 ? 1.0 : 0.0)));
        }
      EXPECT_LT(worst, 2e-3) << g << " " << sigma;
    }
}

// In a thin medium hardly any incident light is lost, and one scattering adds
//   int y_i(s) sigma c(s) sum_j g^l y_j(s) l_j ds,
// where c(s) is the distance to the cube's face.
TEST(PhasedTransfer, OfAThinMediumIsOneScatteringByItsPhase) {
  constexpr float kSigma = 1e-3f;
  for (const float g : {0.4f, -0.4f, 0.7f}) {
    const VolumeTransfer t = phased(cube(kSigma), gridOf(5, 4, 4096), g, 0.5f);
    const SphereTable table(40000, 4);
    for (const std::size_t column : {0u, 2u, 3u, 6u, 12u})
      for (std::size_t i = 0; i < t.outputs(); ++i) {
        double wanted = 0.0;
        for (std::size_t r = 0; r < table.size(); ++r) {
          const glm::vec3 d = glm::abs(table.direction(r));
          const double face = 0.5 / double{std::max({d.x, d.y, d.z})};
          const auto y = table.harmonics(r);
          if (column < t.outputs())
            wanted += double{y[i]} * double{y[column]} * face *
                      std::pow(double{g}, sh::bandOf(static_cast<int>(column)));
        }
        wanted *= 4.0 * std::numbers::pi / static_cast<double>(table.size());
        const double added = arrivingAt(t, kCenter, 1, i, column) - arrivingAt(t, kCenter, 0, i, column);
        EXPECT_NEAR(added / (0.5 * double{kSigma}), wanted, 4e-3) << g << " " << column << " " << i;
        EXPECT_NEAR(arrivingAt(t, kCenter, 0, i, column), i == column ? 1.0 : 0.0, 1e-3);
      }
  }
}

// Estimates what arrives at a place by random walks with delta tracking, backwards: coefficients for uniform
// light and for y_10, [output][2].
std::vector<std::array<double, 2>> walkedWithPhase(const DensityField& density, float largest,
                                                   glm::vec3 place, double albedo, float g, int bands,
                                                   int walks) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto outputs = static_cast<std::size_t>(bands * bands);
  std::vector<std::array<double, 2>> sum(outputs);
  std::vector<float> y(outputs);
  for (int walk = 0; walk < walks; ++walk) {
    glm::vec3 p = place;
    double weight = 1.0;
    const double z = 2.0 * unit(random) - 1.0, phi = 2.0 * std::numbers::pi * unit(random);
    glm::vec3 s(glm::dvec3(std::sqrt(1.0 - z * z) * glm::dvec2(std::cos(phi), std::sin(phi)), z));
    sh::evaluate(bands, s, std::span<float>(y));
    for (bool out = false; !out;) {
      for (;;) {
        p += static_cast<float>(-std::log(1.0 - unit(random)) / double{largest}) * s;
        const glm::vec3 grid = density.gridFromGroup(p);
        out = glm::any(glm::lessThan(grid, glm::vec3(0.0f))) ||
              glm::any(glm::greaterThan(grid, glm::vec3(density.size())));
        if (out || unit(random) * double{largest} < double{density.atGrid(grid)}) break;
      }
      if (out) break;
      weight *= albedo;
      s = reference::samplePhase(g, s, glm::vec2(unit(random), unit(random)));
    }
    const double light[] = {0.28209479177, 0.48860251190 * double{s.z}};
    for (std::size_t i = 0; i < outputs; ++i)
      for (std::size_t c = 0; c < 2; ++c)
        sum[i][c] += 4.0 * std::numbers::pi * weight * double{y[i]} * light[c] / walks;
  }
  return sum;
}

void expectWalks(const Fog& fog, float largest, float g, const VolumeSettings& settings, double albedo,
                 const std::vector<glm::vec3>& places, double tolerance) {
  const VolumeTransfer t = phased(fog, settings, g, static_cast<float>(albedo));
  for (const glm::vec3& place : places) {
    const auto wanted = walkedWithPhase(*fog.field, largest, place, albedo, g, t.bands, 60000);
    double off = 0.0, all = 0.0;
    for (std::size_t i = 0; i < t.outputs(); ++i)
      for (std::size_t c = 0; c < 2; ++c) {
        const double share = std::pow(double{g}, sh::bandOf(static_cast<int>(i)));
        // With one output, transfer is the mean radiance.
        const double is = (t.bands == 1 ? kRoot4Pi : 1.0) * arrivingAt(t, place, 1, i, c == 0 ? 0 : 2);
        off += share * share * (is - wanted[i][c]) * (is - wanted[i][c]);
        all += share * share * wanted[i][c] * wanted[i][c];
        if (i == 0) {
          EXPECT_NEAR(is, wanted[i][c], tolerance * wanted[0][0]) << g << " " << c << " " << place.x;
        }
      }
    // The error is measured over all bands together.
    EXPECT_LT(std::sqrt(off / all), tolerance + 0.01) << g << " " << place.x;
  }
}

TEST(PhasedTransfer, OfACubeIsThatOfRandomWalks) {
  const Fog fog = cube(4.0f);
  for (const float g : {0.4f, -0.4f, 0.8f})
    expectWalks(fog, 4.0f, g, gridOf(9, 4, 512), 0.9, {{0, 0, 0}, {0.25f, 0.0f, 0.25f}}, 0.02);
}

TEST(PhasedTransfer, OfACloudIsThatOfRandomWalks) {
  const DensityGrid cloud = proceduralCloud(7);
  constexpr float kLargest = 20.0f;
  Fog fog = cube(1.0f);
  fog.values = cloud.values;
  for (float& value : fog.values) value *= kLargest;
  fog.field = std::make_shared<DensityField>(cloud.size, fog.values, glm::mat4(cloud.file_from_grid));
  const TransferGrid grid(*fog.field, fog.values, glm::uvec3(16));
  for (const float g : {0.4f, 0.8f})
    expectWalks(fog, kLargest, g, gridOf(16, 4, 512), 0.95,
                {grid.place(grid.samples() / 3), grid.place(grid.samples() * 3 / 4)}, 0.02);
  const TransferGrid fine(*fog.field, fog.values, glm::uvec3(24));
  std::vector<glm::vec3> places;
  for (const double share : {0.15, 0.3, 0.5, 0.75, 0.85})
    places.push_back(fine.place(static_cast<std::size_t>(share * static_cast<double>(fine.samples()))));
  expectWalks(fog, kLargest, 0.0f, gridOf(24, 2, 512), 0.95, places, 0.02);
}

TEST(PhasedTransfer, OfThreeAlbedosIsThatOfEachByItself) {
  const Fog fog = cube(4.0f);
  const VolumeSettings settings = gridOf(4, 3, 256);
  for (const float g : {0.0f, 0.5f}) {
    const VolumeTransfer colored = transferOf(fog, settings, {1.0f, 0.5f, 0.0f}, {}, g);
    ASSERT_EQ(colored.full_channels, 3u);
    const VolumeTransfer white = phased(fog, settings, g), half = phased(fog, settings, g, 0.5f);
    const std::size_t block = colored.outputs() * colored.columns();
    for (std::size_t p = 0; p < colored.grid.samples(); ++p)
      for (std::size_t i = 0; i < block; ++i) {
        const float* v = &colored.vectors[p * 4 * block];
        ASSERT_EQ(v[block + i], white.vectors[(p * 2 + 1) * block + i]);
        ASSERT_EQ(v[2 * block + i], half.vectors[(p * 2 + 1) * block + i]);
        ASSERT_NEAR(v[3 * block + i], v[i], g == 0.0f ? 1e-6f : 1e-5f);  // scatters nothing
      }
    EXPECT_EQ(phased(fog, settings, g, 0.0f).full_channels, 0u);
  }
}

TEST(PhasedTransfer, GainsFromEveryScatteringUpToTheWhole) {
  const Fog fog = cube(4.0f);
  for (const float g : {0.0f, 0.5f}) {
    VolumeSettings settings = gridOf(6, 2, 256);
    const auto uniform = [&](std::size_t block) {
      return (g == 0.0f ? kRoot4Pi : 1.0) *
             arrivingAt(phased(fog, settings, g, 0.9f), {0, 0, 0}, block, 0, 0);
    };
    const double whole = uniform(1);
    double before = uniform(0);
    for (const int times : {1, 2, 4, 60}) {
      settings.scatterings = times;
      const double now = uniform(1);
      EXPECT_GT(now, before) << times;
      EXPECT_LT(now, whole + 1e-4) << times;
      before = now;
    }
    EXPECT_NEAR(before, whole, 1e-3);
  }
}

TEST(PhasedTransfer, StaysFiniteAndInRangeForTheNarrowestPhasesAtAnyOpticalDepth) {
  for (const float g : {0.99f, -0.99f, 0.999999f})
    for (const float sigma : {1e-6f, 10.0f, 1e3f, 1e6f})
      for (const float albedo : {0.5f, 1.0f}) {
        const VolumeTransfer t = phased(cube(sigma), gridOf(5, 4, 256), g, albedo);
        for (std::size_t p = 0; p < t.grid.samples(); ++p) {
          for (std::size_t i = 0; i < t.vectorSize(); ++i) {
            const float value = t.vectors[p * t.vectorSize() + i];
            ASSERT_TRUE(std::isfinite(value)) << g << " " << sigma;
            ASSERT_LE(std::abs(value), 1.5f) << g << " " << sigma << " " << albedo << " " << i;
          }
          const float uniform = t.vectors[p * t.vectorSize() + t.outputs() * t.columns()];
          ASSERT_GE(uniform, -0.01f) << g << " " << sigma;
          ASSERT_LE(uniform, 1.01f) << g << " " << sigma;
        }
      }
}

TEST(PhasedTransfer, IsTheSameWithOneThreadWithTwoAndWithRaysThatDoNotFit) {
  const Fog fog = cube(6.0f, 3);
  for (const float g : {0.0f, 0.4f}) {
    VolumeSettings settings = gridOf(6, 3, 256);
    const auto on = [&](unsigned threads) {
      std::vector<float> vectors;
      withThreads(threads, [&] { vectors = phased(fog, settings, g, 0.9f).vectors; });
      return vectors;
    };
    const std::vector<float> one = on(1);
    EXPECT_EQ(on(2), one);
    settings.memory = 1000;
    EXPECT_EQ(on(2), one);
  }
}

TEST(PhasedTransfer, CutByAWallSeesHalfTheSkyOnEachSide) {
  const testing::Transport walled(
      testing::sceneOf({testing::turned(testing::grid({0, 0, 0}, 1000.0f, 2), 90.0f, {0, 0, 1})}));
  const Occluders occluders(walled.rays, glm::mat4(1.0f));
  const VolumeTransfer t = transferOf(cube(0.01f), gridOf(6, 2), glm::vec3(1.0f), occluders, 0.5f);
  for (const double side : {-0.25, 0.25}) {
    EXPECT_NEAR(arrivingAt(t, {side, 0, 0}, 0, 0, 0), 0.5, 0.01);
    EXPECT_NEAR(arrivingAt(t, {side, 0, 0}, 0, 3, 0), std::copysign(0.4330127, side), 0.006);
    EXPECT_LT(arrivingAt(t, {side, 0, 0}, 1, 0, 0), 0.52);  // and scattering does not light through it
  }
}

}  // namespace
}  // namespace lambent::baker
