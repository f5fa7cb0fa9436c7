// Tests glossy surfaces from the scene through the baker to the frame, with known answers.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/stability/show.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

using testing::add;
using testing::constantLight;
using testing::named;
using testing::Show;

// Makes a white ball of a material that reflects all its light, or as much as one lobe of GGX does.
assets::Scene ball(float roughness, float metallic, float anisotropy = 0.0f) {
  assets::Scene scene = named("ball");
  add(scene, "ball", assets::sphere(1.0f, 12), glm::vec3(1.0f), glm::vec3(0.0f), /*movable=*/false);
  scene.materials[0].roughness = roughness;
  scene.materials[0].metallic = metallic;
  scene.materials[0].specular = 1.0f;
  scene.materials[0].anisotropy = anisotropy;
  return scene;
}

// Returns what the ball shows where the view makes this angle with the normal.
glm::vec3 seenAt(Show& show, float angle_deg) {
  const float a = glm::radians(angle_deg);
  const glm::vec3 normal(std::sin(a), 0.0f, std::cos(a));
  return show.patch(normal + glm::vec3(0.0f, 0.0f, 4.0f), normal);
}

using GlossyEndToEnd = testing::GpuTest;

TEST_F(GlossyEndToEnd, WhiteMetalInAWhiteWorldNeverGivesMoreThanItGets) {
  for (const auto& [anisotropy, roughness] : {std::pair{0.0f, 0.1f}, {0.0f, 1.0f}, {0.8f, 0.1f}}) {
    Show show(ball(roughness, /*metallic=*/1.0f, anisotropy), {constantLight(1.0f)});
    for (const float angle : {0.0f, 40.0f, 82.0f}) {
      const glm::vec3 seen = seenAt(show, angle);
      EXPECT_LE(seen.g, 1.002f);
      EXPECT_NEAR(seen.r, seen.b, 1e-4f);
      if (roughness < 0.5f && anisotropy == 0.0f) {
        EXPECT_GE(seen.g, 0.98f) << angle;
      }
      // GGX of alpha 1 seen from above: D = 1/pi, G2 = 2 c / (c + 1), so the integral is that of c / (c + 1).
      if (roughness == 1.0f && angle == 0.0f) {
        EXPECT_NEAR(seen.g, 1.0 - std::numbers::ln2, 0.003);
      }
    }
  }
}

TEST_F(GlossyEndToEnd, AClosedRoomOfMetalUnderAStrongSunIsDark) {
  assets::Scene scene = named("room");
  assets::Mesh room = assets::box({-1, -1, -1}, {1, 1, 1}, 0.4f);
  for (std::size_t i = 0; i + 2 < room.indices.size(); i += 3)
    std::swap(room.indices[i], room.indices[i + 1]);
  for (glm::vec3& normal : room.normals) normal = -normal;
  add(scene, "room", std::move(room), glm::vec3(0.9f), glm::vec3(0.0f), /*movable=*/false);
  add(scene, "hull", assets::box({-1.1f, -1.1f, -1.1f}, {1.1f, 1.1f, 1.1f}, 0.5f), glm::vec3(0.5f),
      glm::vec3(0.0f),
      /*movable=*/false);
  scene.materials[0].roughness = 0.3f;
  scene.materials[0].metallic = 1.0f;
  Show show(
      scene,
      {spec::SunLight{
          .azimuth_deg = 30.0f, .elevation_deg = 50.0f, .angle_deg = 2.0f, .radiance = glm::vec3(1e6f)}});
  const glm::vec3 seen = show.patch({0.3f, 0.2f, 0.1f}, {-1.0f, -0.5f, -0.4f});
  EXPECT_LT(std::abs(seen.g), 1.0f) << "a millionth of the sun";
}

}  // namespace
}  // namespace lambent
