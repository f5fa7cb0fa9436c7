// Tests how captures run: one at a time, in pages, and each shader like its CPU twin.
#include <random>

#include <gtest/gtest.h>

#include "runtime/lighting/capture_ref.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/lighting/capture_fixture.hpp"
#include "tests/runtime/lighting/capture_scenes.hpp"

namespace lambent::lighting {
namespace {

using testing::cubeProxy;
using testing::discProxy;
using testing::facing;
using testing::squaredError;
using testing::squareProxy;

}  // namespace

using CaptureRuns = CaptureTest;

TEST_F(CaptureRuns, RunsAreTakenOnceAndOneAtATime) {
  const Environment environment = uniformSky(1);
  auto capture = Capture::create({}, environment);
  ASSERT_TRUE(capture);
  EXPECT_FALSE(capture->take(true));
  const bundle::CaptureProxy square = squareProxy();
  const bundle::CaptureProxy* const proxies[] = {&square};
  capture->setProxies(proxies, counters);
  const gpu::Buffer radiance("radiance", 32), too_small("too small", 16);
  const CaptureBody bodies[] = {{0, facing({0, 3, 0}, {}, 1)}};
  const CapturePoint points[] = {{}};
  EXPECT_FALSE(capture->run(environment, bodies, points, too_small, counters));
  EXPECT_TRUE(capture->run(environment, bodies, points, radiance, counters));
  EXPECT_TRUE(capture->pending());
  EXPECT_FALSE(capture->run(environment, bodies, points, radiance, counters));
  std::optional<std::vector<CapturedLight>> light;
  while (!(light = capture->take(false))) {
  }
  EXPECT_EQ(light->size(), 1u);
  EXPECT_FALSE(capture->pending());
  EXPECT_FALSE(capture->take(true));
}

TEST_F(CaptureRuns, DrawsAndDispatchesDependOnPagesOnly) {
  Scene scene{.options = {.subsamples = 4}, .proxies = {cubeProxy()}};
  for (int i = 0; i < 50; ++i)
    scene.bodies.push_back({0, glm::translate(glm::mat4(1), 4.0f * glm::vec3(i % 7, i / 7, 0))});
  for (std::uint32_t i = 0; i < 50; ++i)
    scene.points.push_back({.position_ws = 4.0f * glm::vec3(i % 7, i / 7, 0), .own_body = i});
  captured(uniformSky(1), scene);
  EXPECT_EQ(load.pages, 1u);
  EXPECT_EQ(load.points, 50u);
  EXPECT_EQ(counters.draws, 1u);
  EXPECT_EQ(counters.dispatches, 4u) << "two of them for the sky";
}

TEST_F(CaptureRuns, ProxiesThatAreKnownAgainAreDrawnAsIfTheyWereNew) {
  const Environment environment = uniformSky(1);
  const bundle::CaptureProxy cube = cubeProxy(), square = squareProxy(), disc = discProxy(20);
  using Proxies = std::vector<const bundle::CaptureProxy*>;
  auto known = Capture::create({.size = 8, .order = 4}, environment);
  ASSERT_TRUE(known);
  // Bodies are added one by one, change places and are removed.
  const std::vector<std::pair<Proxies, std::vector<std::uint64_t>>> steps = {
      {{&cube}, {1}},
      {{&square, &cube}, {2, 1}},
      {{&square, &disc, &cube}, {2, 3, 1}},
      {{&cube, &disc, &cube}, {1, 3, 4}},
      {{&disc, &square}, {3, 5}}};
  for (const auto& [proxies, keys] : steps) {
    auto anew = Capture::create({.size = 8, .order = 4}, environment);
    ASSERT_TRUE(anew);
    known->setProxies(proxies, counters, keys);
    anew->setProxies(proxies, counters);
    ASSERT_EQ(known->triangleCount(), anew->triangleCount());
    std::vector<glm::vec4> shine;
    for (std::uint32_t i = 0; i < known->triangleCount(); ++i) shine.emplace_back(0.1f * float(i), 1, 2, 0);
    gpu::Buffer radiance("radiance", shine.size() * sizeof(glm::vec4));
    radiance.write(0, std::span<const glm::vec4>(shine));
    std::vector<CaptureBody> bodies;
    for (std::uint32_t i = 0; i < proxies.size(); ++i) {
      EXPECT_EQ(known->firstTriangle(i), anew->firstTriangle(i));
      bodies.push_back({i, facing({2.0f * static_cast<float>(i) - 2, 2, 1}, {}, 1)});
    }
    const CapturePoint points[] = {{}};
    ASSERT_TRUE(known->run(environment, bodies, points, radiance, counters));
    ASSERT_TRUE(anew->run(environment, bodies, points, radiance, counters));
    const auto found = *known->take(true), expected = *anew->take(true);
    EXPECT_EQ(found[0].light.c, expected[0].light.c);
    EXPECT_GT(squaredError(found[0].light, environment.light().truncated(4)), 1e-3) << "bodies are seen";
  }
}

TEST_F(CaptureRuns, ManyPagesGiveTheLightOfOne) {
  Scene scene{.proxies = {cubeProxy()}, .bodies = {{0, glm::translate(glm::mat4(1), glm::vec3(1.5f, 0, 0))}}};
  for (int i = 0; i < 60; ++i) scene.points.push_back({.position_ws = {0, 0.01f * static_cast<float>(i), 0}});
  const auto all = captured(uniformSky(1), scene);
  EXPECT_GT(load.pages, 1u);
  for (const std::size_t i : {0u, 31u, 59u}) {
    Scene alone = scene;
    alone.points = {scene.points[i]};
    EXPECT_LT(squaredError(captured(uniformSky(1), alone)[0].light, all[i].light), 1e-12) << i;
  }
}

TEST_F(CaptureRuns, TheShadersAgreeWithTheirTwinOn100RandomScenes) {
  std::mt19937 random(20021);
  const auto uniform = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); };
  for (int trial = 0; trial < 100; ++trial) {
    Scene scene{
        .options = {.size = trial % 2 ? 8u : 5u, .subsamples = trial % 3 ? 8u : 7u, .order = 1 + trial % 8}};
    scene.proxies = {cubeProxy(), squareProxy(), squareProxy(true), discProxy(20), cubeProxy(true)};
    std::size_t triangles = 0;
    for (auto& proxy : scene.proxies) triangles += proxy.triangles.size();
    for (std::size_t i = 0; i < triangles; ++i)
      scene.radiance.emplace_back(uniform(0, 3), uniform(0, 1), trial % 10 ? uniform(0, 1) : 1e6f, 0);
    const int count = 1 + trial % 9;
    // Braces, unlike the arguments of a function, are evaluated in order.
    const auto within = [&](float size) {
      return glm::vec3{uniform(-size, size), uniform(-size, size), uniform(-size, size)};
    };
    for (int i = 0; i < count; ++i) {
      const auto proxy = static_cast<std::uint32_t>(uniform(0, 4.99f));
      const glm::vec3 place = within(4), towards = within(9);
      scene.bodies.push_back({proxy, facing(place, towards, uniform(0.3f, 2.5f))});
    }
    for (int i = 0; i < 2; ++i) {
      CapturePoint point{.position_ws = within(3), .own_body = i ? CapturePoint::kNoBody : 0u};
      for (int q = 0; q < 3; ++q)
        point.queries.push_back({.direction = glm::normalize(within(1)),
                                 .angular_radius_rad = q ? uniform(0, 2) : 0.0f,
                                 .distance_m = trial % 2 ? uniform(0, 6) : 0.0f,
                                 .radiance = q ? glm::vec3(uniform(0, 2)) : glm::vec3(0)});
      scene.points.push_back(std::move(point));
    }
    const Environment environment = uniformSky(trial % 4 ? 1.0f : 0.0f);
    const auto light = captured(environment, scene);
    std::vector<const bundle::CaptureProxy*> proxies;
    for (const auto& proxy : scene.proxies) proxies.push_back(&proxy);
    const std::vector<glm::vec3> sky(6 * scene.options.size * scene.options.size,
                                     environment.set(0).constant);
    const capture::RefScene twin{
        scene.options,  proxies, scene.bodies,
        scene.radiance, sky,     sh::constantLight(scene.options.order, environment.set(0).constant)};
    for (std::size_t p = 0; p < scene.points.size(); ++p) {
      const CapturedLight expected = capture::captureRef(twin, scene.points[p]);
      ASSERT_TRUE(allFinite(light[p]));
      // Subsamples on edges may fall to either side; of eight of them the difference stays under this.
      double difference = 0;
      for (std::size_t i = 0; i < expected.light.c.size(); ++i)
        difference += glm::dot(glm::dvec3(light[p].light.c[i] - expected.light.c[i]),
                               glm::dvec3(light[p].light.c[i] - expected.light.c[i]));
      const double subsample_sr = 4 * std::numbers::pi /
                                  (6.0 * scene.options.size * scene.options.size * scene.options.subsamples *
                                   scene.options.subsamples);
      const double brightest = trial % 10 ? 3 : 1e6;
      // So may the directions to a disc, each of which moves the light of its share of the disc.
      double moved = 8 * subsample_sr * brightest;
      for (std::size_t q = 0; q < expected.visible.size(); ++q) {
        const LightQuery& query = scene.points[p].queries[q];
        const double disc_sr = 2 * std::numbers::pi * (1 - std::cos(double{query.angular_radius_rad}));
        moved += 2 * std::abs(double{light[p].visible[q]} - double{expected.visible[q]}) * disc_sr *
                 double{glm::length(query.radiance)};
      }
      EXPECT_LT(std::sqrt(difference), moved * scene.options.order / std::sqrt(4 * std::numbers::pi))
          << "scene " << trial << " point " << p;
      EXPECT_NEAR(light[p].sky_visible.g, expected.sky_visible.g, 2e-3f) << "scene " << trial;
      for (std::size_t q = 0; q < expected.visible.size(); ++q)
        EXPECT_NEAR(light[p].visible[q], expected.visible[q], q ? 0.04f : 0.0f)
            << "scene " << trial << " query " << q;
    }
  }
}

}  // namespace lambent::lighting
