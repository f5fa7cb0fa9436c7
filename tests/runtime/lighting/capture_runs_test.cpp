// Tests how captures run: one at a time, in pages, and that they see what rays see.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "runtime/lighting/capture_plan.hpp"
#include "runtime/sh/image_layout.hpp"
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

// What a ray from the point hits, as in a pixel of the atlas: nothing, the dark side of a triangle, or its
// bright side.
struct Hit {
  std::uint32_t id = 0;
  double distance = std::numeric_limits<double>::infinity();  // in multiples of the direction's length
};

}  // namespace

class CaptureRuns : public CaptureTest {
 protected:
  // Captures a point under a constant sky by rays in double precision: one per subsample, against every
  // triangle. The capture's plan chooses bodies and levels.
  static CapturedLight capturedByRays(const Scene& scene, const CapturePoint& point, const glm::vec3& sky);

 private:
  struct Triangle {
    std::array<glm::dvec3, 3> corners{};
    bool front_only = false;
    std::uint32_t id = 0;
  };
  static std::vector<Triangle> trianglesAt(const Scene& scene, const CapturePoint& point);
  static Hit trace(const std::vector<Triangle>& triangles, const glm::dvec3& direction);
};

std::vector<CaptureRuns::Triangle> CaptureRuns::trianglesAt(const Scene& scene, const CapturePoint& point) {
  std::vector<capture::ProxyBounds> bounds;
  std::vector<std::uint32_t> first_triangle{0};
  for (const bundle::CaptureProxy& proxy : scene.proxies) {
    bounds.push_back(capture::ProxyBounds::of(proxy));
    first_triangle.push_back(first_triangle.back() + static_cast<std::uint32_t>(proxy.triangles.size()));
  }
  const capture::Plan made = capture::plan(scene.options, bounds, scene.bodies, std::span(&point, 1));
  std::vector<Triangle> triangles;
  std::vector<bool> done(scene.bodies.size());
  for (const capture::Draw& draw : made.draws) {
    if (done[draw.body]) continue;  // it was added for another tile
    done[draw.body] = true;
    const CaptureBody& body = scene.bodies[draw.body];
    const bundle::CaptureProxy& proxy = scene.proxies[body.proxy];
    const bundle::ProxyLevel& level = proxy.levels[draw.level];
    for (std::uint32_t t = level.first_triangle; t < level.first_triangle + level.triangle_count; ++t) {
      Triangle& triangle = triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        triangle.corners[k] = glm::dvec3(glm::dmat4(body.world_from_proxy) *
                                         glm::dvec4(proxy.positions[proxy.triangles[t].vertices[k]], 1.0)) -
                              glm::dvec3(point.position_ws);
      triangle.front_only = proxy.triangles[t].front_only;
      triangle.id = first_triangle[body.proxy] + t + 1;
    }
  }
  return triangles;
}

Hit CaptureRuns::trace(const std::vector<Triangle>& triangles, const glm::dvec3& direction) {
  Hit hit;
  for (const Triangle& triangle : triangles) {
    const auto& [a, b, c] = triangle.corners;
    // These are volumes of the tetrahedra that the direction spans with the edges. All have one sign inside.
    const double u = glm::dot(direction, glm::cross(b, c)), v = glm::dot(direction, glm::cross(c, a)),
                 w = glm::dot(direction, glm::cross(a, b));
    const bool front = u <= 0 && v <= 0 && w <= 0, back = u >= 0 && v >= 0 && w >= 0;
    if (front == back || (back && triangle.front_only)) continue;
    const double distance = glm::dot(a, glm::cross(b, c)) / (u + v + w);
    if (!(distance > 0) || distance >= hit.distance) continue;
    hit = {front ? triangle.id : capture::kBlackId, distance};
  }
  return hit;
}

CapturedLight CaptureRuns::capturedByRays(const Scene& scene, const CapturePoint& point,
                                          const glm::vec3& sky) {
  const std::vector<Triangle> triangles = trianglesAt(scene, point);
  const auto size = static_cast<int>(scene.options.size),
             subsamples = static_cast<int>(scene.options.subsamples);
  const double pixels = size * subsamples;
  const auto count = static_cast<std::size_t>(sh::coefficientCount(scene.options.order));
  const std::vector<float> weights = sh::cubeWeights(scene.options.order, size);
  std::vector<glm::dvec4> sums(2 * count);
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        glm::dvec3 bodies(0.0);
        int covered = 0;
        for (int j = y * subsamples; j < (y + 1) * subsamples; ++j)
          for (int i = x * subsamples; i < (x + 1) * subsamples; ++i) {
            const std::uint32_t id = trace(triangles, sh::cubeFaceDirection(face, 2 * (i + 0.5) / pixels - 1,
                                                                            2 * (j + 0.5) / pixels - 1))
                                         .id;
            if (id == 0) continue;
            ++covered;
            if (id != capture::kBlackId) bodies += glm::dvec3(scene.radiance[id - 1]);
          }
        const auto texel = static_cast<std::size_t>((face * size + y) * size + x);
        const double share = static_cast<double>(covered) / (subsamples * subsamples);
        sums[0].w += 1.0 - share;
        for (std::size_t i = 0; i < count; ++i) {
          const double weight =
              static_cast<double>(weights[i * static_cast<std::size_t>(6 * size * size) + texel]);
          sums[2 * i] += glm::dvec4(weight / (subsamples * subsamples) * bodies, 0.0);
          sums[2 * i + 1] += weight * share * glm::dvec4(sky, 1.0);
        }
      }
  CapturedLight out;
  const sh::LightVector sky_light = sh::constantLight(scene.options.order, sky);
  capture::combine(std::vector<glm::vec4>(sums.begin(), sums.end()), 0, sky_light, sky_light, out);
  for (const LightQuery& query : point.queries) {
    std::uint32_t bits = 0, k = 0;
    for (const glm::vec3& direction : capture::discDirections(query)) {
      // The ray goes through the centre of the pixel that the direction falls into, as the lookup on the GPU
      // does.
      const std::uint32_t face = capture::faceOf(direction);
      const glm::dvec3 at = capture::faceFromWorld(face) * glm::dvec3(direction);
      const auto middle = [&](double s) {
        return 2 * (std::min(std::floor((s + 1) / 2 * pixels), pixels - 1) + 0.5) / pixels - 1;
      };
      const Hit hit = trace(
          triangles, sh::cubeFaceDirection(static_cast<int>(face), middle(at.x / at.z), middle(at.y / at.z)));
      const double w = static_cast<double>(query.distance_m) * at.z;
      if (hit.id != 0 && (w <= 0 || hit.distance < w / (1 + capture::kSameDistance))) bits |= 1u << k;
      ++k;
    }
    out.visible.push_back(capture::visibleShare(query, bits));
  }
  return out;
}

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
  EXPECT_EQ(counters.draws, 2u) << "bright and dark sides";
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
    for (std::uint32_t i = 0; i < proxies.size(); ++i)
      bodies.push_back({i, facing({2.0f * static_cast<float>(i) - 2, 2, 1}, {}, 1)});
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

TEST_F(CaptureRuns, SeeWhatRaysSeeIn100RandomScenes) {
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
      for (int q = 0; q < 3; ++q) {
        point.queries.push_back({.direction = glm::normalize(within(1)),
                                 .angular_radius_rad = q ? uniform(0, 2) : 0.0f,
                                 .distance_m = trial % 2 ? uniform(0, 6) : 0.0f});
        if (q > 0) random.discard(1);  // keeps the scenes that the tolerances are known for
      }
      scene.points.push_back(std::move(point));
    }
    const Environment environment = uniformSky(trial % 4 ? 1.0f : 0.0f);
    const auto light = captured(environment, scene);
    for (std::size_t p = 0; p < scene.points.size(); ++p) {
      const CapturedLight expected = capturedByRays(scene, scene.points[p], environment.set(0).constant);
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
      EXPECT_LT(std::sqrt(difference),
                8 * subsample_sr * brightest * scene.options.order / std::sqrt(4 * std::numbers::pi))
          << "scene " << trial << " point " << p;
      EXPECT_NEAR(light[p].sky_visible.g, expected.sky_visible.g, 2e-3f) << "scene " << trial;
      for (std::size_t q = 0; q < expected.visible.size(); ++q)
        EXPECT_NEAR(light[p].visible[q], expected.visible[q], q ? 0.04f : 0.0f)
            << "scene " << trial << " query " << q;
    }
  }
}

}  // namespace lambent::lighting
