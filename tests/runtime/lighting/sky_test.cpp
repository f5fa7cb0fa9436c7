// Checks that the drawn sky is the radiance of the environment as rotated, faded and scaled.
#include "runtime/lighting/sky.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::lighting {

class SkyTest : public testing::GpuTest {
 protected:
  // Returns what the middle pixel of a narrow picture along dir shows.
  static glm::vec3 seen(const Sky& sky, const Environment& environment, glm::vec3 dir) {
    constexpr std::uint32_t kSide = 5;
    const gpu::Texture color("color", {.format = GL_RGBA32F, .width = kSide, .height = kSide});
    const gpu::Framebuffer target("target", color, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    glViewport(0, 0, kSide, kSide);
    glClear(GL_COLOR_BUFFER_BIT);
    const glm::vec3 up = std::abs(dir.y) > 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    gpu::Counters counters;
    sky.draw(environment, glm::lookAt(glm::vec3(0.0f), dir, up), glm::perspective(0.05f, 1.0f, 0.1f, 10.0f),
             kSide, counters);
    std::vector<glm::vec4> texels(kSide * kSide);
    glGetTextureImage(color.id(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(texels.size() * 16),
                      texels.data());
    return glm::vec3(texels[kSide * kSide / 2]);
  }
};

TEST_F(SkyTest, ShowsTheMixOfBothSets) {
  auto environment = Environment::create(
      {spec::ConstantLight{.radiance = {1, 2, 3}},
       spec::SunLight{.azimuth_deg = 20, .elevation_deg = 0, .angle_deg = 8, .radiance = {4, 4, 4}}},
      {spec::ConstantLight{.radiance = {0, 0, 8}},
       spec::SunLight{.azimuth_deg = 90, .elevation_deg = 60, .angle_deg = 9, .radiance = {2, 0, 1}}});
  ASSERT_TRUE(environment);
  const auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky) << sky.error().line();
  environment->setTurn(-30.0f);
  environment->setFade(0.75f);
  environment->setIntensity(2.0f);
  const auto expectSeen = [&](float azimuth, float elevation, glm::vec3 expected) {
    const glm::vec3 found = seen(*sky, *environment, spec::directionFromAzimuthElevation(azimuth, elevation));
    EXPECT_LT(glm::distance(found, expected), 1e-4f)
        << azimuth << ", " << elevation << ": " << found.r << " " << found.g << " " << found.b;
  };
  const glm::vec3 between(0.5f, 1.0f, 13.5f);  // 0.5 of the first set, 1.5 of the second
  expectSeen(120, -10, between);
  expectSeen(-10, 0, between + glm::vec3(2.0f));
  expectSeen(60, 60, between + glm::vec3(3.0f, 0.0f, 1.5f));
}

// An infinite texel of half floats would make its neighbours NaN, and so would it times a fade of 0.
TEST_F(SkyTest, ShowsRadianceBeyondHalfFloatsAsTheLargest) {
  auto environment = Environment::create({spec::ConstantLight{.radiance = {1e6f, 1.0f, 1e9f}}},
                                         {spec::ConstantLight{.radiance = {0, 0, 8}}});
  ASSERT_TRUE(environment);
  const auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky) << sky.error().line();
  const glm::vec3 brightest = seen(*sky, *environment, {0, 0, 1});
  EXPECT_NEAR(brightest.r, 65504.0f, 1.0f);
  EXPECT_NEAR(brightest.g, 1.0f, 1e-3f);
  EXPECT_NEAR(brightest.b, 65504.0f, 1.0f);
  environment->setFade(1.0f);
  EXPECT_LT(glm::distance(seen(*sky, *environment, {0, 0, 1}), glm::vec3(0, 0, 8)), 1e-3f);
}

// A key light that was moved is visible in its new place, and no longer in the old.
TEST_F(SkyTest, ShowsAMovedKeyLightAsADiscInPlaceOfItsTexels) {
  const glm::vec3 sun = spec::directionFromAzimuthElevation(40, 50);
  spec::RgbImage image{.width = 256, .height = 128, .texels = {}};
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 256; ++x) {
      const glm::dvec3 dir = sh::texelDirection(sh::ImageLayout::LatLong, 256, 128, x, y);
      image.texels.push_back(glm::distance(glm::vec3(dir), sun) < 0.05f ? glm::vec3(1000.0f)
                                                                        : glm::vec3(1.0f));
    }
  const auto file = std::filesystem::path(::testing::TempDir()) / (std::to_string(getpid()) + "-sky.hdr");
  ASSERT_TRUE(spec::writeHdr(file, image));
  auto environment = Environment::create({spec::EnvironmentMapLight{file, std::nullopt}});
  std::filesystem::remove(file);
  ASSERT_TRUE(environment);
  environment->setMostKeys(16);
  ASSERT_EQ(environment->foundKeys().size(), 1u);
  auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky) << sky.error().line();
  const glm::vec3 to = spec::directionFromAzimuthElevation(-60, 10);
  EXPECT_NEAR(seen(*sky, *environment, sun).r, 1000.0f, 20.0f);
  EXPECT_NEAR(seen(*sky, *environment, to).r, 1.0f, 0.02f);
  const std::uint64_t version = PrefilteredEnvironment::sourceVersion(*environment);
  environment->setKeyEdits({{.found = sun, .towards = to, .factor = {0.5f, 0.25f, 0.0f}}});
  const Environment::FoundKey key = environment->foundKeys()[0];
  ASSERT_TRUE(key.edit);
  EXPECT_TRUE(sky->update(*environment));
  EXPECT_FALSE(sky->update(*environment));
  const glm::vec3 moved = seen(*sky, *environment, to);
  EXPECT_NEAR(moved.r, key.now.radiance.r + 1.0f, 0.02f * key.now.radiance.r);
  EXPECT_NEAR(moved.g, key.now.radiance.g + 1.0f, 0.02f * key.now.radiance.g);
  EXPECT_NEAR(moved.b, 1.0f, 0.02f) << "none of this channel is left";
  EXPECT_LT(seen(*sky, *environment, sun).r, 300.0f) << "what the rest keeps";
  EXPECT_EQ(PrefilteredEnvironment::sourceVersion(*environment), version) << "mirrors show the disc apart";
  environment->setKeyEdits({});
  EXPECT_TRUE(sky->update(*environment));
  EXPECT_NEAR(seen(*sky, *environment, sun).r, 1000.0f, 20.0f);
}

// Compares the prefiltered sky for rough mirrors with the lobe's own integrals.

namespace {

constexpr double kPi = std::numbers::pi;

std::vector<glm::vec4> levelOf(const gpu::Texture& cube, std::uint32_t level) {
  const std::uint32_t side = cube.desc().width >> level;
  std::vector<glm::vec4> texels(6ull * side * side);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glGetTextureImage(cube.id(), static_cast<GLint>(level), GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
  return texels;
}

// Returns the part of the lobe about `direction` that falls into a disc, by midpoints over the hemisphere;
// small discs use their solid angle.
double shareOfDisc(const ReflectedLobe& lobe, const glm::dvec3& direction, const Disc& disc) {
  const double least = std::cos(static_cast<double>(disc.radius_rad));
  if (disc.radius_rad < 0.02f)
    return 2.0 * kPi * (1.0 - least) *
           static_cast<double>(
               lobe.density(static_cast<float>(glm::dot(direction, glm::dvec3(disc.direction)))));
  const glm::dvec3 side =
      glm::normalize(std::abs(direction.y) < 0.9 ? glm::cross(direction, glm::dvec3(0, 1, 0))
                                                 : glm::cross(direction, glm::dvec3(1, 0, 0)));
  const glm::dvec3 up = glm::cross(side, direction);
  constexpr int kRings = 1500, kSides = 720;
  double sum = 0.0;
  for (int r = 0; r < kRings; ++r) {
    const double u = (r + 0.5) / kRings, theta = 0.5 * kPi * u * u, step = kPi * u / kRings;
    const double weight = static_cast<double>(lobe.density(static_cast<float>(std::cos(theta)))) *
                          std::sin(theta) * step * 2.0 * kPi / kSides;
    for (int s = 0; s < kSides; ++s) {
      const double phi = 2.0 * kPi * (s + 0.5) / kSides;
      const glm::dvec3 at =
          std::cos(theta) * direction + std::sin(theta) * (std::cos(phi) * side + std::sin(phi) * up);
      if (glm::dot(at, glm::dvec3(disc.direction)) >= std::cos(static_cast<double>(disc.radius_rad)))
        sum += weight;
    }
  }
  return sum;
}

}  // namespace

TEST(ReflectedLobe, HoldsAllOfItselfAndNarrowsToAMirror) {
  float before = 1.0f;
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    const ReflectedLobe lobe = makeReflectedLobe(roughness);
    EXPECT_NEAR(lobe.bands[0], 1.0f, 1e-6f);
    EXPECT_LE(lobe.bands[4], before);
    before = lobe.bands[4];
  }
  // Roughness 1: D is constant, so K = cos / pi, and the bands are A_l / pi.
  const ReflectedLobe wide = makeReflectedLobe(1.0f);
  EXPECT_NEAR(wide.bands[1], 2.0f / 3.0f, 1e-4f);
  EXPECT_NEAR(wide.bands[2], 0.25f, 1e-4f);
  EXPECT_NEAR(wide.bands[3], 0.0f, 1e-4f);
  EXPECT_NEAR(wide.density(1.0f), 1.0 / kPi, 1e-4);
  // Half of cos / pi lies within 45 degrees.
  EXPECT_NEAR(0.5f * (wide.angles_rad[127] + wide.angles_rad[128]), kPi / 4, 1e-3);
}

using PrefilteredEnvironmentTest = testing::GpuTest;

TEST_F(PrefilteredEnvironmentTest, ASunIsBlurredToTheLobesShareOfIt) {
  for (const float radius_deg : {1.0f, 12.0f, 40.0f}) {
    const auto environment = Environment::create({spec::SunLight{
        .azimuth_deg = 33, .elevation_deg = 21, .angle_deg = radius_deg, .radiance = glm::vec3(8, 4, 2)}});
    ASSERT_TRUE(environment);
    const auto sky = Sky::create(*environment);
    ASSERT_TRUE(sky);
    gpu::Counters counters;
    const auto reflected = PrefilteredEnvironment::make(*environment, *sky, counters);
    ASSERT_TRUE(reflected) << reflected.error().line();
    const Disc disc = environment->discs()[0];
    for (const std::uint32_t level :
         radius_deg < 2.0f ? std::vector<std::uint32_t>{3, 4, 6} : std::vector<std::uint32_t>{2, 3, 4, 6}) {
      const ReflectedLobe lobe = makeReflectedLobe(roughnessOfLevel(level, kReflectedLevels));
      const std::vector<glm::vec4> texels = levelOf(reflected->cube(0), level);
      const auto side = static_cast<int>(reflected->cube(0).desc().width >> level);
      double brightest = 0.0;
      for (const glm::vec4& texel : texels) brightest = testing::larger(brightest, texel.r);
      for (int i = 0; i < 6 * side * side; i += 1 + 6 * side * side / 23) {
        const glm::dvec3 direction =
            sh::cubeTexelDirection(side, i / (side * side), i % side, i / side % side);
        const double expected = 8.0 * shareOfDisc(lobe, direction, disc);
        EXPECT_NEAR(texels[static_cast<std::size_t>(i)].r, expected, 0.02 * brightest)
            << radius_deg << " degrees, level " << level;
      }
    }
  }
}

TEST_F(PrefilteredEnvironmentTest, LightOfFewBandsLeavesNothing) {
  // The environment map has bands 0 to 2, so the reflection is each band times the lobe's.
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + "-bands.exr");
  constexpr std::uint32_t kWidth = 256, kHeight = 128;
  spec::RgbaImage image{.width = kWidth, .height = kHeight, .texels = {}};
  const auto radiance = [](const glm::dvec3& d) {
    return glm::dvec3(1.0 + 0.5 * d.z, 1.0 + 0.3 * d.x * d.y, 2.0 - d.y + 0.4 * d.z * d.z);
  };
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const double azimuth = ((x + 0.5) / kWidth - 0.5) * 2.0 * kPi, polar = (y + 0.5) / kHeight * kPi;
      const glm::dvec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                         std::sin(polar) * std::sin(azimuth));
      image.texels.emplace_back(glm::vec3(radiance(d)), 1.0f);
    }
  ASSERT_TRUE(spec::writeExr(path, image));
  auto environment = Environment::create({spec::EnvironmentMapLight{.file = path, .layout = {}}});
  std::filesystem::remove(path);
  ASSERT_TRUE(environment) << environment.error().line();
  const auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky);
  gpu::Counters counters;
  auto reflected = PrefilteredEnvironment::make(*environment, *sky, counters);
  ASSERT_TRUE(reflected);
  reflected->update(*environment, 5, sh::Window::Off, counters);
  for (std::uint32_t level = 0; level < kReflectedLevels; ++level) {
    const std::vector<glm::vec4> texels = levelOf(reflected->cube(0), level);
    const auto side = static_cast<int>(reflected->cube(0).desc().width >> level);
    double difference = 0.0;
    for (int i = 0; i < 6 * side * side; ++i) {
      const glm::vec3 direction = sh::cubeTexelDirection(side, i / (side * side), i % side, i / side % side);
      std::array<float, 25> y{};
      sh::evaluate(5, direction, y);
      glm::vec3 known(0.0f);
      for (std::size_t k = 0; k < 25; ++k) {
        const int l = sh::bandOf(static_cast<int>(k));
        const std::size_t row = 2 * level + static_cast<std::size_t>(l) / 4;
        known += y[k] * reflected->values().bands[row][l % 4] * glm::vec3(reflected->values().light[k]);
      }
      difference =
          testing::larger(difference, glm::distance(known, glm::vec3(texels[static_cast<std::size_t>(i)])));
    }
    // The radiance goes up to 3, and passes several half-float look-ups in an environment map of 64 texels
    // per face.
    EXPECT_LT(difference, 0.02) << "level " << level;
  }
}

// Lamps are along the edges of cube faces, in an environment map that needs cubes of 125 texels. After
// prefiltering all of their light is still there.
TEST_F(PrefilteredEnvironmentTest, LampsInAProbeOfAnySizeKeepTheirPower) {
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + "-lamps.exr");
  constexpr std::uint32_t kWidth = 500, kHeight = 250;
  constexpr double kLampRadius = 0.02;
  spec::RgbaImage image{.width = kWidth, .height = kHeight, .texels = {}};
  double power = 0.0;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const double azimuth = ((x + 0.5) / kWidth - 0.5) * 2.0 * kPi, polar = (y + 0.5) / kHeight * kPi;
      const glm::dvec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                         std::sin(polar) * std::sin(azimuth));
      double radiance = 0.05;
      for (const glm::dvec3& lamp : {glm::dvec3(1, 0.2, 0.995), glm::dvec3(0.995, -0.3, -1),
                                     glm::dvec3(-1, 0.995, 0.4), glm::dvec3(-0.3, -0.995, 1)})
        if (glm::dot(d, glm::normalize(lamp)) > std::cos(kLampRadius)) radiance = 200.0;
      image.texels.emplace_back(glm::vec3(static_cast<float>(radiance)), 1.0f);
      power += radiance * std::sin(polar) * (kPi / kHeight) * (2.0 * kPi / kWidth);
    }
  ASSERT_TRUE(spec::writeExr(path, image));
  const auto environment = Environment::create({spec::EnvironmentMapLight{.file = path, .layout = {}}});
  std::filesystem::remove(path);
  ASSERT_TRUE(environment) << environment.error().line();
  const auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky);
  gpu::Counters counters;
  const auto reflected = PrefilteredEnvironment::make(*environment, *sky, counters);
  ASSERT_TRUE(reflected);
  for (std::uint32_t level = 2; level < kReflectedLevels; ++level) {
    const std::vector<glm::vec4> texels = levelOf(reflected->cube(0), level);
    const auto side = static_cast<int>(reflected->cube(0).desc().width >> level);
    double sum = 0.0, whole = 0.0;
    for (int i = 0; i < 6 * side * side; ++i) {
      // The solid angle of a texel falls with the cube of the distance of its point from the cube's centre.
      const double u = (2.0 * (i % side) + 1.0) / side - 1.0,
                   v = (2.0 * (i / side % side) + 1.0) / side - 1.0;
      const double angle = std::pow(1.0 + u * u + v * v, -1.5);
      sum += angle * static_cast<double>(texels[static_cast<std::size_t>(i)].g);
      whole += angle;
    }
    EXPECT_NEAR(4.0 * kPi * sum / whole / power, 1.0, 0.05) << "level " << level;
  }
}

TEST_F(PrefilteredEnvironmentTest, TurningFadingAndDimmingOnlyMixAnew) {
  auto environment = Environment::create({spec::ConstantLight{.radiance = {1, 2, 3}}},
                                         {spec::ConstantLight{.radiance = {0, 0, 8}}});
  ASSERT_TRUE(environment);
  const auto sky = Sky::create(*environment);
  gpu::Counters counters;
  auto reflected = PrefilteredEnvironment::make(*environment, *sky, counters);
  ASSERT_TRUE(reflected);
  counters = {};
  environment->setTurn(90.0f);
  environment->setFade(0.25f);
  environment->setIntensity(2.0f);
  reflected->update(*environment, 5, sh::Window::Off, counters);
  EXPECT_EQ(counters.dispatches, 0u);
  const ReflectionValues& values = reflected->values();
  const glm::vec3 mixed = values.shares.x * glm::vec3(levelOf(reflected->cube(0), 3)[5]) +
                          values.shares.y * glm::vec3(levelOf(reflected->cube(1), 3)[5]);
  EXPECT_LT(glm::distance(mixed, glm::vec3(1.5f, 3.0f, 8.5f)), 1e-2f);
  EXPECT_LT(glm::distance(0.28209479f * glm::vec3(values.light[0]), mixed), 1e-2f) << "and it is all known";
  const std::uint64_t uploaded = counters.uploaded_bytes;
  reflected->update(*environment, 5, sh::Window::Off, counters);
  EXPECT_EQ(counters.uploaded_bytes, uploaded);
}

}  // namespace lambent::lighting
