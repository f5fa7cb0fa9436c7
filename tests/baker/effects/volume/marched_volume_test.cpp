// Tests a baked volume as other groups see it.
#include "baker/effects/volume/marched_volume.hpp"

#include <array>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "tests/baker/effects/volume/media.hpp"

namespace lambent::baker {
namespace {

using testing::cube;
using testing::transferOf;

VolumeSettings coarse() {
  VolumeSettings settings;
  settings.order = 2;
  settings.rays = 256;
  settings.grid = glm::uvec3(8);
  return settings;
}

TEST(MarchedVolume, ThatAbsorbsNothingIsNotSeenInUniformLight) {
  const MarchedVolume volume(transferOf(cube(4.0f), coarse()));
  const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, 0.2f, -0.4f));
  for (const glm::vec3& origin : {glm::vec3(0.0f), glm::vec3(-2.0f, -0.3f, 0.7f), glm::vec3(0.45f)}) {
    std::array<float, 12> scattered;
    const float clear = volume.look(origin, direction, 100.0f, scattered);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(clear + scattered[4 * c] * std::sqrt(4.0f * std::numbers::pi_v<float>), 1.0f, 5e-3f);
  }
}

TEST(MarchedVolume, ThatAbsorbsNothingIsNotSeenInUniformLightWhateverItsPhase) {
  for (const float g : {0.5f, -0.7f}) {
    const MarchedVolume volume(transferOf(cube(4.0f), coarse(), glm::vec3(1.0f), {}, g));
    const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, 0.2f, -0.4f));
    for (const glm::vec3& origin : {glm::vec3(0.0f), glm::vec3(-2.0f, -0.3f, 0.7f), glm::vec3(0.45f)}) {
      std::array<float, 12> scattered;
      const float clear = volume.look(origin, direction, 100.0f, scattered);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(clear + scattered[4 * c] * std::sqrt(4.0f * std::numbers::pi_v<float>), 1.0f, 5e-3f);
    }
  }
}

// Along a chord of depth d, a thin volume adds d sum_i g^l(i) l_i y_i(direction) of the light l. With g > 0
// this is more for light that travels towards the eye.
TEST(MarchedVolume, ThatIsThinScattersWhatComesFromBehindItByItsPhase) {
  constexpr float kSigma = 1e-3f, kG = 0.6f;
  const MarchedVolume volume(transferOf(cube(kSigma), coarse(), glm::vec3(0.5f), {}, kG));
  const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, 0.0f, 0.5f));
  std::array<float, 12> scattered;
  volume.look(-2.0f * direction, direction, 100.0f, scattered);
  const float chord = std::sqrt(1.25f);
  std::array<float, 4> y;
  sh::evaluate(2, direction, std::span<float>(y));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(scattered[i] / (0.5f * kSigma * chord), y[i] * (i == 0 ? 1.0f : kG), 3e-3f) << i;
}

TEST(MarchedVolume, LetsThroughWhatTheChordLetsThrough) {
  const MarchedVolume volume(transferOf(cube(2.0f), coarse(), glm::vec3(0.5f, 0.25f, 0.0f)));
  std::array<float, 12> scattered;
  EXPECT_NEAR(volume.look({-3, 0, 0}, {1, 0, 0}, 100.0f, scattered), std::exp(-2.0f), 1e-4f);
  EXPECT_GT(scattered[0], scattered[4]);
  EXPECT_GT(scattered[4], 0.0f);
  EXPECT_EQ(scattered[8], 0.0f);  // blue scatters nothing
  EXPECT_NEAR(volume.look({-3, 0, 0}, {1, 0, 0}, 2.75f, scattered), std::exp(-0.5f), 1e-4f);
}

TEST(MarchedVolume, ThatIsEmptyIsInvisibleToTheLastBit) {
  const MarchedVolume volume(transferOf(cube(0.0f, 4), coarse()));
  std::array<float, 12> scattered;
  EXPECT_EQ(volume.look({-3, 0, 0}, {1, 0, 0}, 100.0f, scattered), 1.0f);
  for (const float value : scattered) EXPECT_EQ(value, 0.0f);
}

}  // namespace
}  // namespace lambent::baker
