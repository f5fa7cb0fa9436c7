#include "reference/phase.hpp"

#include <array>

#include <gtest/gtest.h>

#include "reference/sampler.hpp"

namespace lambent::baker::reference {
namespace {

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
