#include "runtime/lighting/group_lights.hpp"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::lighting {
namespace {

Environment sunAlong(float azimuth_deg) {
  return *Environment::create(
      {spec::SunLight{.azimuth_deg = azimuth_deg, .elevation_deg = 0, .angle_deg = 30}});
}

}  // namespace

using GroupLightsTest = testing::GpuTest;

TEST_F(GroupLightsTest, GiveEachGroupTheLightInItsOwnFrame) {
  GroupLights lights;
  gpu::Counters counters;
  // Group 1 is turned by 90 degrees about +Y: its +X is the world's -Z, so a sun on +X stands on its +Z.
  const GroupPlace places[] = {{.order = 5},
                               {.world_from_group = glm::angleAxis(1.5707963f, glm::vec3(0, 1, 0)),
                                .order = 4,
                                .lamps = {{1, 2, 3}, {4, 0, 0}}}};
  lights.update(sunAlong(90), sh::Window::Off, places, counters);
  EXPECT_EQ(lights.firstOf(0), 0u);
  constexpr std::uint32_t kStride = GroupLights::kStride;
  EXPECT_EQ(lights.firstOf(1), kStride);
  ASSERT_EQ(lights.coefficients().size(), 2 * kStride + 3 * 2);
  EXPECT_FALSE(lights.hasKeys());
  const sh::LightVector upright = sunAlong(90).light().truncated(5),
                        turned = sunAlong(0).light().truncated(4);
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_LT(glm::distance(glm::vec3(lights.coefficients()[i]), upright.c[i]), 1e-5f);
    EXPECT_LT(glm::distance(glm::vec3(lights.coefficients()[kStride + i]), turned.c[i]), 1e-5f);
    EXPECT_EQ(lights.coefficients()[GroupLights::kBlock + i], glm::vec4(0.0f)) << "no key lights";
  }
  EXPECT_EQ(lights.coefficients()[2 * kStride], glm::vec4(1, 2, 3, 0)) << "lamps follow, as they are";
  EXPECT_EQ(lights.coefficients()[2 * kStride + 1], glm::vec4(4, 0, 0, 0));
}

TEST_F(GroupLightsTest, ManyWindowsAtOnceAreThoseOfEachByItselfAndScaledLightsKeepThem) {
  GroupLights lights;
  gpu::Counters counters;
  const Environment environment = sunAlong(90);
  std::vector<sh::LightVector> arriving;  // small lights, which ring
  for (int i = 0; i < 60; ++i) {
    const float turn = 0.1f * static_cast<float>(i);
    arriving.push_back(sh::discLight(5, {std::cos(turn), 0, std::sin(turn)}, 0.05 + 0.01 * i, {1, 2, 3}));
    arriving.back().c[0] += 0.1f * turn;
  }
  std::vector<GroupPlace> places = {{.order = 5, .incident = {}, .key = 1}};
  std::uint64_t version = 0;
  for (const sh::LightVector& light : arriving)
    places[0].incident.push_back({.light = &light, .version = ++version});
  lights.update(environment, sh::Window::Auto, places, counters);
  for (std::size_t s = 0; s < arriving.size(); ++s) {
    const sh::LightVector expected = sh::applyWindow(arriving[s], sh::Window::Auto);
    ASSERT_NE(expected.c, arriving[s].c);
    for (std::size_t i = 0; i < 25; ++i)
      EXPECT_LT(glm::distance(glm::vec3(lights.coefficients()[GroupLights::kStride * s + i]), expected.c[i]),
                1e-6f);
  }
  const std::vector<glm::vec4> before(lights.coefficients().begin(), lights.coefficients().end());
  for (std::size_t s = 0; s < arriving.size(); ++s) {
    arriving[s] *= 2.0f;
    places[0].incident[s].version = ++version;
  }
  lights.update(environment, sh::Window::Auto, places, counters);
  EXPECT_EQ(lights.renewedSamples(), 60u);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(lights.coefficients()[i], 2.0f * before[i]);
}

TEST_F(GroupLightsTest, ALampThatChangesIsNewLightForItsGroupOnly) {
  GroupLights lights;
  gpu::Counters counters;
  const Environment environment = sunAlong(10);
  std::vector<GroupPlace> places = {{.order = 3, .lamps = {{1, 1, 1}}}, {.order = 3, .lamps = {{1, 1, 1}}}};
  lights.update(environment, sh::Window::Auto, places, counters);
  const std::uint64_t first = lights.versionOf(0), second = lights.versionOf(1);
  places[1].lamps[0] = {0, 0, 5};
  lights.update(environment, sh::Window::Auto, places, counters);
  EXPECT_EQ(lights.versionOf(0), first);
  EXPECT_GT(lights.versionOf(1), second);
  EXPECT_EQ(lights.coefficients()[lights.lampsOf(1)], glm::vec4(0, 0, 5, 0));
}

TEST_F(GroupLightsTest, LampsThatShinePerPixelStandApartAndAllPartsAddUp) {
  GroupLights lights;
  gpu::Counters counters;
  const Environment environment = sunAlong(10);
  std::vector<GroupPlace> places = {{.order = 3, .lamps = {{1, 2, 3}, {4, 5, 6}}}};
  const auto expect = [&](glm::vec3 rest, glm::vec3 apart) {
    lights.update(environment, sh::Window::Off, places, counters);
    const std::span<const glm::vec4> all = lights.coefficients();
    const std::uint32_t whole = lights.lampsOf(0), parted = lights.partedLampsOf(0);
    EXPECT_EQ(all[whole], glm::vec4(1, 2, 3, 0));
    EXPECT_EQ(all[whole + 1], glm::vec4(4, 5, 6, 0));
    EXPECT_EQ(all[parted], glm::vec4(1, 2, 3, 0)) << "this one has no cube";
    EXPECT_EQ(all[parted + 1], glm::vec4(rest, 0));
    EXPECT_EQ(all[parted + 2], glm::vec4(0.0f));
    EXPECT_EQ(all[parted + 3], glm::vec4(apart, 0));
    EXPECT_EQ(lights.hasPartedLamps(), apart != glm::vec3(0.0f));
  };
  expect({4, 5, 6}, glm::vec3(0.0f));
  const std::uint64_t before = lights.lampsVersionOf(0);
  places[0].lamps_apart = {0.0f, 1.0f};
  expect(glm::vec3(0.0f), {4, 5, 6});
  EXPECT_GT(lights.lampsVersionOf(0), before) << "another carrier is other light for the samples";
  EXPECT_EQ(lights.changeOf(0), 0.0f) << "but the same light for what the group sends out";
  places[0].lamps_apart = {0.0f, 0.25f};
  expect({3, 3.75f, 4.5f}, {1, 1.25f, 1.5f});
  places[0].parted = false;
  expect({4, 5, 6}, glm::vec3(0.0f));
}

TEST_F(GroupLightsTest, BandsThatDoNotCountAreZeroAndTheWindowIsThatOfTheOthers) {
  GroupLights lights;
  gpu::Counters counters;
  const Environment environment = sunAlong(90);
  const sh::LightVector captured = sunAlong(30).light();
  const std::vector<GroupPlace> places = {{.order = 5, .incident = {{}, {.light = &captured, .version = 1}}}};
  lights.update(environment, sh::Window::Auto, places, counters);
  const std::uint64_t before = lights.versionOf(0);
  lights.update(environment, sh::Window::Auto, places, counters, /*max_order=*/3);
  EXPECT_GT(lights.versionOf(0), before);
  const sh::LightVector expected[] = {sh::applyWindow(environment.light().truncated(3), sh::Window::Auto),
                                      sh::applyWindow(captured.truncated(3), sh::Window::Auto)};
  for (std::size_t sample = 0; sample < 2; ++sample)
    for (std::size_t i = 0; i < 64; ++i)
      EXPECT_LT(glm::distance(glm::vec3(lights.coefficients()[lights.firstOf(0, sample) + i]),
                              i < 9 ? expected[sample].c[i] : glm::vec3(0.0f)),
                1e-5f)
          << i;
}

TEST_F(GroupLightsTest, HaveNewVersionsOnlyWhereSomethingChanged) {
  GroupLights lights;
  gpu::Counters counters;
  Environment environment = sunAlong(10);
  std::vector<GroupPlace> places = {{.order = 3}, {.order = 3}};
  lights.update(environment, sh::Window::Auto, places, counters);
  const std::uint64_t first = lights.versionOf(0), second = lights.versionOf(1),
                      uploaded = counters.uploaded_bytes;
  lights.update(environment, sh::Window::Auto, places, counters);
  EXPECT_EQ(lights.versionOf(0), first);
  EXPECT_EQ(counters.uploaded_bytes, uploaded);
  places[1].world_from_group = glm::angleAxis(0.1f, glm::vec3(0, 0, 1));
  lights.update(environment, sh::Window::Auto, places, counters);
  EXPECT_EQ(lights.versionOf(0), first);
  EXPECT_GT(lights.versionOf(1), second);
  environment.setTurn(1.0f);
  lights.update(environment, sh::Window::Auto, places, counters);
  EXPECT_GT(lights.versionOf(0), first);
  const std::uint64_t before = lights.versionOf(0);
  lights.update(environment, sh::Window::Off, places, counters);
  EXPECT_GT(lights.versionOf(0), before) << "the window is part of the light";
}

}  // namespace lambent::lighting
