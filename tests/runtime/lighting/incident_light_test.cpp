#include "runtime/lighting/incident_light.hpp"

#include <cmath>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/runtime/lighting/capture_fixture.hpp"
#include "tests/runtime/lighting/capture_scenes.hpp"

namespace lambent::lighting {
namespace {

constexpr std::uint32_t kBodies = 40;
const CaptureOptions kOptions{.size = 8, .subsamples = 2, .order = 3};

// Finds by a walk over all bodies what has changed since a sample's surroundings were drawn.
struct Walk {
  std::vector<IncidentBody> bodies;  // as drawn
  std::vector<bool> seen;
  glm::vec3 position_ws{0.0f};

  bool seesNothing() const { return std::ranges::find(seen, true) == seen.end(); }
  float changeTo(const Walk& now) const {
    float squared = 0.0f;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!seen[b] && !now.seen[b]) continue;
      const bool other = seen[b] != now.seen[b];
      const IncidentBody& before = seen[b] ? bodies[b] : now.bodies[b];
      const IncidentBody& after = now.seen[b] ? now.bodies[b] : bodies[b];
      const float part =
          shareOfLight(changeOf(before, position_ws, after, now.position_ws), other, kOptions.order);
      squared += part * part;
    }
    return std::sqrt(squared);
  }
};

}  // namespace

using IncidentLightTest = testing::GpuTest;

TEST_F(IncidentLightTest, DrawsWhatAWalkOverAllBodiesFindsChanged) {
  const Environment environment = uniformSky(1);
  Result<IncidentLight> incident = IncidentLight::create(kOptions, environment);
  ASSERT_TRUE(incident);
  gpu::Counters counters;
  const bundle::CaptureProxy cube = testing::cubeProxy();
  const std::vector<const bundle::CaptureProxy*> proxies = {&cube};
  incident->captures().setProxies(proxies, counters);
  const capture::ProxyBounds bounds = capture::ProxyBounds::of(cube);
  const gpu::Buffer radiance("radiance", incident->captures().triangleCount() * sizeof(glm::vec4));

  std::mt19937 engine(2003);
  const auto uniform = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(engine); };
  std::vector<IncidentBody> bodies;
  std::vector<IncidentGroup> groups;
  const auto place = [&](std::size_t b, const glm::vec3& at) {
    bodies[b].body.world_from_proxy = glm::scale(glm::translate(glm::mat4(1.0f), at), glm::vec3(0.2f));
    bodies[b].center_ws = at;
    groups[b].samples_ws = {at};
  };
  for (std::uint32_t b = 0; b < kBodies; ++b) {
    bodies.push_back({.body = {}, .radius_m = 0.2f * bounds.radius_m, .key = 100 + b});
    groups.push_back({.body = b, .samples_ws = {}, .key = 100 + b, .samples = b});
    place(b, {uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)});
  }
  groups[7].left_out = {3, 9};

  std::vector<Walk> drawn(kBodies);
  std::size_t all_drawn = 0, all_waiting = 0;
  for (int step = 0; step < 25; ++step) {
    // Some bodies move a little or far, some change their radiance.
    if (step > 0)
      for (int i = 0; i < 3; ++i) {
        const auto b = static_cast<std::size_t>(uniform(0, kBodies - 0.01f));
        const float far = step % 5 == 0 ? 2.0f : 0.05f;
        place(b, bodies[b].center_ws + glm::vec3{uniform(-far, far), uniform(-far, far), uniform(-far, far)});
        bodies[static_cast<std::size_t>(uniform(0, kBodies - 0.01f))].radiance_drift += 0.3;
      }
    std::size_t expected = 0, waiting = 0;
    for (std::uint32_t g = 0; g < kBodies; ++g) {
      Walk now{.bodies = bodies, .seen = {}, .position_ws = groups[g].samples_ws[0]};
      for (std::uint32_t b = 0; b < kBodies; ++b) {
        const bool left_out = b == g || std::ranges::count(groups[g].left_out, b) > 0;
        now.seen.push_back(!left_out && capture::sees(kOptions, now.position_ws,
                                                      capture::BodySphere::of(bodies[b].body, bounds)));
      }
      ASSERT_FALSE(now.seesNothing()) << "all stand close to each other here";
      const float change = step == 0 ? kWhollyChanged : drawn[g].changeTo(now);
      if (change > kMovingChange) {
        ++expected;
        drawn[g] = std::move(now);
      } else if (change > kRestingChange) {
        ++waiting;
      }
    }
    incident->update(environment, groups, {}, /*wait=*/true);
    ASSERT_TRUE(incident->capture(environment, {groups, bodies, {}}, radiance, kBodies, counters));
    EXPECT_EQ(incident->counts().captured, expected) << "step " << step;
    EXPECT_EQ(incident->counts().waiting, waiting) << "step " << step;
    if (step > 0) all_drawn += expected, all_waiting += waiting;
  }
  EXPECT_GT(all_drawn, 100u);
  EXPECT_LT(all_drawn, 20u * kBodies) << "or all of it was drawn always";
  EXPECT_GT(all_waiting, 20u);
}

}  // namespace lambent::lighting
