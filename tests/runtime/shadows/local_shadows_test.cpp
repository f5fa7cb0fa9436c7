// Tests pictures under local lights with known answers: small bundles in the dark, lit by one light.
#include "runtime/shadows/local_shadows.hpp"

#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/runtime/shadows/shadow_shaders.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/local_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {

using LocalShadowsTest = testing::GpuTest;

TEST_F(LocalShadowsTest, PunctualLightsAndSeveralLightsAddUp) {
  Stage stage(BundleBuilder().add(level(0.0f, 5.0f, {0, 0}, 0.5f)));
  LocalLight spot;
  spot.kind = LocalLight::Kind::Spot;
  spot.position_ws = {0, 1, 0};
  spot.direction_ws = {0, -1, 0};
  spot.power = {10, 0, 1};
  spot.range_m = 2.0f;
  spot.inner_cone_rad = 0.3f;
  spot.outer_cone_rad = 0.9f;
  const auto expected = [&](glm::vec2 at) {
    const float d2 = 1.0f + glm::dot(at, at), cosine = 1.0f / std::sqrt(d2);
    const float share = std::clamp((cosine - std::cos(0.9f)) / (std::cos(0.3f) - std::cos(0.9f)), 0.0f, 1.0f);
    return 0.5f * 10.0f / d2 * cosine / kPi * share * share * std::max(1.0f - d2 * d2 / 16.0f, 0.0f);
  };
  expectFloor(stage.picture(above(2.0f), spot), 2.0f, 0.01f, expected, "spot");
  LocalLight sphere = sphereLight({0.5f, 1.0f, 0.5f}, 0.1f, {3, 2, 1});
  const auto alone = stage.picture(above(2.0f), sphere);
  const std::vector<LocalLight> both = {spot, sphere};
  const auto together = stage.picture(above(2.0f), both);
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const std::size_t i = y * kSize + x;
      const float wanted = alone[i].r + expected({placeOf(x, 2.0f), placeOf(y, 2.0f)});
      ASSERT_NEAR(together[i].r, wanted, 0.01f * wanted);
    }
  stage.masks = {2u};
  EXPECT_EQ(stage.picture(above(2.0f), both), alone) << "the second alone shines on this group";
}

TEST_F(LocalShadowsTest, BlendedSurfacesAreLitAndCastNoShadowAndUnlitOnesStayAsTheyAre) {
  BuiltMesh glass = level(0.5f, 5.0f), sign = level(0.4f, 5.0f, {5, 0});
  glass.material.base_color.a = 0.25f;
  glass.material.alpha_mode = gltf::AlphaMode::Blend;
  sign.material.unlit = true;
  Stage stage(BundleBuilder().add(level(0.0f, 5.0f)).add(glass).add(sign));
  LocalLight light;
  light.position_ws = {0, 2, 0};
  light.power = glm::vec3(8.0f * kPi);
  const auto picture = stage.picture(above(1.0f), light);
  const float floor = 8.0f * 2.0f / 8.0f, pane = 8.0f * 1.5f / (2.25f * 1.5f);
  const auto at = [&](std::uint32_t x) {  // at z = 0, by how far light falls in from the side
    const float s = placeOf(x, 1.0f), z = placeOf(32, 1.0f);
    return std::pair(std::pow(1.0f + (s * s + z * z) / 4.0f, -1.5f),
                     std::pow(1.0f + (s * s + z * z) / 2.25f, -1.5f));
  };
  const auto [on_floor, on_pane] = at(20);
  EXPECT_NEAR(picture[32 * kSize + 20].r, 0.75f * floor * on_floor + 0.25f * pane * on_pane, 0.01f);
  const auto [unused, over_sign] = at(44);
  EXPECT_NEAR(picture[32 * kSize + 44].r, 0.75f * 1.0f + 0.25f * pane * over_sign, 0.01f);
}

TEST_F(LocalShadowsTest, AFloorThatLightGrazesIsLitAllOver) {
  Stage stage(BundleBuilder().add(level(0.0f, 5.0f)));
  constexpr float kHeight = 0.05f;
  const auto distance2 = [](glm::vec2 at) { return glm::dot(at, at) + kHeight * kHeight; };
  LocalLight light = sphereLight({0, kHeight, 0}, 0.02f, glm::vec3(100.0f));
  expectFloor(
      stage.picture(above(4.0f), light), 4.0f, 0.01f,
      [&](glm::vec2 at) {
        const float d = std::sqrt(distance2(at)), h = d / 0.02f;
        if (kHeight / d * h < 1.0f) return 0.0f;
        return 100.0f * kHeight / d / (h * h);
      },
      "sphere");
  light.kind = LocalLight::Kind::Point;
  expectFloor(
      stage.picture(above(4.0f), light), 4.0f, 0.01f,
      [&](glm::vec2 at) { return 100.0f * kHeight / std::pow(distance2(at), 1.5f) / kPi; }, "point");
  light.kind = LocalLight::Kind::Disc;
  light.direction_ws = {0, -1, 0};
  const auto disc = stage.picture(above(4.0f), light);
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      // At this distance the differential form is exact to (r/d)^2.
      const glm::vec2 at(placeOf(x, 4.0f), placeOf(y, 4.0f));
      if (glm::length(at) < 0.3f) continue;
      const float d2 = distance2(at), wanted = 100.0f * 0.02f * 0.02f * kHeight * kHeight / (d2 * d2);
      ASSERT_NEAR(disc[y * kSize + x].r, wanted, 0.02f * wanted) << "disc at " << at.x << " " << at.y;
    }
}

TEST_F(LocalShadowsTest, AnEdgeCastsAPenumbraOfTheRightWidthAndShape) {
  // The edge is along x = 0, halfway between floor and light, so the penumbra is as wide as the light, 0.4.
  for (const std::uint32_t samples : {16u, 64u}) {
    Stage stage(BundleBuilder().add(level(0.0f, 5.0f)).add(level(1.0f, 2.0f, {-2.0f, 0})),
                {.samples = samples});
    constexpr float kHalf = 0.5f, kRadius = 0.2f;
    for (const LocalLight::Kind kind : {LocalLight::Kind::Sphere, LocalLight::Kind::Disc}) {
      LocalLight light = sphereLight({0, 2, 0}, kRadius, glm::vec3(10.0f));
      light.kind = kind;
      light.direction_ws = {0, -1, 0};
      const auto picture = stage.picture(above(kHalf), light);
      double error = 0.0;
      for (std::uint32_t x = 0; x < kSize; ++x) {
        float mean = 0.0f, whole = 0.0f;
        for (std::uint32_t y = 0; y < kSize; ++y) {
          const glm::vec3 to(-placeOf(x, kHalf), 2.0f, -placeOf(y, kHalf));
          const float d2 = glm::dot(to, to), cosine = 2.0f / std::sqrt(d2);
          mean += picture[y * kSize + x].r;
          whole += 10.0f * kRadius * kRadius / d2 * cosine * (kind == LocalLight::Kind::Disc ? cosine : 1.0f);
        }
        // This is the fraction of a disc beyond a line at s radii from its centre.
        const float s = std::clamp(placeOf(x, kHalf) / kRadius, -1.0f, 1.0f);
        const float expected = (std::acos(-s) + s * std::sqrt(1.0f - s * s)) / kPi;
        EXPECT_NEAR(mean / whole, expected, samples == 64 ? 0.02f : 0.04f) << "x " << placeOf(x, kHalf);
        error += std::abs(double{mean / whole} - expected) / kSize;
      }
      EXPECT_LT(error, samples == 64 ? 0.006 : 0.01);
    }
  }
}

namespace {

// Returns the share of rays to all over a sphere, from a point, that are not blocked.
double shareByRays(const glm::vec3& to_light, float radius,
                   const std::function<bool(const glm::vec3&)>& blocked) {
  glsl::LocalShader shader;
  glm::vec3 s, t;
  shader.localBasis(glm::normalize(to_light), s, t);
  int visible = 0;
  constexpr int kRays = 400;
  for (int i = 0; i < kRays; ++i) {
    const glm::vec2 at = radius * shader.discPoint(i, kRays, 0.0f);
    visible += blocked(to_light + at.x * s + at.y * t) ? 0 : 1;
  }
  return visible / double{kRays};
}

}  // namespace

TEST_F(LocalShadowsTest, ShadowsOfSeveralBlockersAreNearThoseOfRaysToEveryPointOfTheLight) {
  struct Blocker {
    float height, half;
    glm::vec2 center;
  };
  const std::vector<std::vector<Blocker>> scenes = {
      {{1.0f, 0.3f, {0, 0}}},  // smaller than the penumbra is wide at its corners
      {{0.3f, 0.2f, {-0.4f, 0}}, {1.2f, 0.2f, {0.2f, 0.1f}}},  // apart
      {{0.1f, 0.3f, {0.3f, 0}}, {0.9f, 0.2f, {0, 0}}}};        // one behind the other
  for (const auto& blockers : scenes) {
    const bool hidden = &blockers == &scenes.back();
    BundleBuilder builder;
    builder.add(level(0.0f, 5.0f));
    for (const Blocker& b : blockers) builder.add(level(b.height, b.half, b.center));
    for (const std::uint32_t samples : {16u, 64u}) {
      Stage stage(builder, {.samples = samples});
      constexpr float kHalf = 1.2f, kRadius = 0.25f;
      const glm::vec3 light(0.1f, 2.0f, 0.0f);
      const auto picture = stage.picture(above(kHalf, 0.05f), sphereLight(light, kRadius, glm::vec3(1.0f)));
      double error = 0.0, squares = 0.0, shadowed = 0.0;
      for (std::uint32_t y = 0; y < kSize; ++y)
        for (std::uint32_t x = 0; x < kSize; ++x) {
          const glm::vec3 place(placeOf(x, kHalf), 0.0f, placeOf(y, kHalf)), to = light - place;
          const double share = shareByRays(to, kRadius, [&](const glm::vec3& ray) {
            return std::ranges::any_of(blockers, [&](const Blocker& b) {
              const glm::vec3 hit = place + b.height / ray.y * ray;
              return std::abs(hit.x - b.center.x) < b.half && std::abs(hit.z - b.center.y) < b.half;
            });
          });
          const float d2 = glm::dot(to, to), whole = kRadius * kRadius / d2 * to.y / std::sqrt(d2);
          const double apart = double{picture[y * kSize + x].r / whole} - share;
          error += apart / (kSize * kSize);
          squares += apart * apart / (kSize * kSize);
          shadowed += (1.0 - share) / (kSize * kSize);
        }
      // Errors are relative to the light. Few sample points miss the rims of penumbras, and are noisy within
      // them.
      EXPECT_LT(std::abs(error), samples == 64 ? 0.008 : 0.015) << "the shadow is as dark on the whole";
      EXPECT_LT(std::sqrt(squares), samples == 64 && !hidden ? 0.02 : 0.06);
      EXPECT_GT(shadowed, 0.05);
    }
  }
}

TEST_F(LocalShadowsTest, TheShadowOfARoundBodyIsDarkInsideAndRightAtItsRim) {
  // The blocker's heights range from 0.2 to 0.8.
  Stage stage(BundleBuilder()
                  .add(level(0.0f, 5.0f))
                  .add({sphereMesh(48, 96), grey(0.5f),
                        glm::translate(glm::mat4(1.0f), glm::vec3(0, 0.5f, 0)) *
                            glm::scale(glm::mat4(1.0f), glm::vec3(0.3f))}));
  constexpr float kHalf = 0.8f, kRadius = 0.15f;
  const glm::vec3 light(0.4f, 2.0f, 0.1f), body(0, 0.5f, 0);
  const auto picture = stage.picture(above(kHalf, 0.1f), sphereLight(light, kRadius, glm::vec3(1.0f)));
  std::size_t dark = 0, leaks = 0;
  double squares = 0.0;
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const glm::vec3 place(placeOf(x, kHalf), 0.0f, placeOf(y, kHalf)), to = light - place;
      const double share = shareByRays(to, kRadius, [&](const glm::vec3& ray) {
        return glm::length(glm::cross(glm::normalize(ray), body - place)) <= 0.3f;
      });
      const float d2 = glm::dot(to, to), whole = kRadius * kRadius / d2 * to.y / std::sqrt(d2);
      const double apart = double{picture[y * kSize + x].r / whole} - share;
      squares += apart * apart / (kSize * kSize);
      dark += share == 0.0 ? 1 : 0;
      leaks += share == 0.0 && apart > 0.1 ? 1 : 0;  // two points of sixteen
    }
  EXPECT_GT(dark, 300u);
  // At the umbra's rim, rays hit the body below the part that the light's centre sees.
  EXPECT_LE(leaks, dark / 25);
  EXPECT_LT(std::sqrt(squares), 0.04);
}

TEST_F(LocalShadowsTest, AClosedRoomIsLitEverywhereWithoutLinesInItsCorners) {
  // The scene has the six inner walls of a cube from -1 to 1.
  BundleBuilder builder;
  const glm::mat4 out = glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, -1));  // faces +Z, behind the origin
  const glm::vec3 y(0, 1, 0), x(1, 0, 0);
  for (const float turn : {0.0f, 0.5f * kPi, kPi, 1.5f * kPi})
    builder.add({quadMesh(), grey(1.0f), glm::rotate(glm::mat4(1.0f), turn, y) * out});
  for (const float turn : {0.5f * kPi, -0.5f * kPi})
    builder.add({quadMesh(), grey(1.0f), glm::rotate(glm::mat4(1.0f), turn, x) * out});
  Stage stage(builder);
  const glm::vec3 place(0.3f, -0.2f, 0.1f), eye(-0.5f, 0.4f, 0.6f);
  for (const LocalLight::Kind kind : {LocalLight::Kind::Point, LocalLight::Kind::Sphere}) {
    LocalLight light = sphereLight(place, 0.1f, glm::vec3(100.0f));
    light.kind = kind;
    for (const glm::vec3 towards : {glm::vec3(1, -1, -1), glm::vec3(1, 1, -1), glm::vec3(1, -1, 0.8f)}) {
      const spec::View view{.view_from_world = glm::lookAt(eye, towards, y),
                            .clip_from_view = glm::perspective(1.4f, 1.0f, 0.01f, 10.0f),
                            .eye_ws = eye};
      const auto picture = stage.picture(view, light);
      std::size_t wrong = 0;
      for (std::uint32_t row = 0; row < kSize; ++row)
        for (std::uint32_t column = 0; column < kSize; ++column) {
          // The pixel's ray meets the nearest of the walls.
          const float t = std::tan(0.7f);
          const glm::vec3 ray = glm::transpose(glm::mat3(view.view_from_world)) *
                                glm::vec3(t * placeOf(column, 1.0f), -t * placeOf(row, 1.0f), -1.0f);
          float far = 1e9f;
          glm::vec3 normal(0.0f);
          for (int i = 0; i < 3; ++i)
            if (const float way = ((ray[i] > 0.0f ? 1.0f : -1.0f) - eye[i]) / ray[i]; way < far) {
              far = way;
              normal = glm::vec3(0.0f);
              normal[i] = ray[i] > 0.0f ? -1.0f : 1.0f;
            }
          const glm::vec3 to = place - (eye + far * ray);
          const float d2 = glm::dot(to, to), cosine = glm::dot(to, normal) / std::sqrt(d2);
          const float wanted = 100.0f * cosine / d2 * (kind == LocalLight::Kind::Point ? 1.0f / kPi : 0.01f);
          wrong += std::abs(picture[row * kSize + column].r - wanted) > 0.02f * wanted ? 1 : 0;
        }
      // Pixels that two walls share.
      EXPECT_LE(wrong, 2u) << "kind " << static_cast<int>(kind);
    }
  }
}

TEST_F(LocalShadowsTest, ASphereInACurvedRoomIsLitEverywhere) {
  gltf::Material material = grey(1.0f);
  material.double_sided = true;
  Stage stage(BundleBuilder().add({sphereMesh(48, 96), material, glm::mat4(1.0f)}));
  const spec::View view{
      .view_from_world = glm::lookAt(glm::vec3(0, 0, 0.3f), glm::vec3(0.3f, 0.2f, -1), {0, 1, 0}),
      .clip_from_view = glm::perspective(1.5f, 1.0f, 0.01f, 10.0f),
      .eye_ws = {0, 0, 0.3f}};
  // E = pi L (r/d)^2 at d = 1; the mesh's facets are up to 0.2 % nearer.
  for (const glm::vec4& pixel : stage.picture(view, sphereLight({0, 0, 0}, 0.1f, glm::vec3(100.0f))))
    ASSERT_NEAR(pixel.r, 1.0f, 0.01f);
}

TEST_F(LocalShadowsTest, BlockersShadowFromOnePercentOfTheDistanceOn) {
  // A small square is just above the floor, 2 m below the light: from 1 % of that distance on, its shadow is
  // complete.
  for (const float height : {0.02f, 0.2f}) {
    Stage stage(BundleBuilder().add(level(0.0f, 5.0f)).add(level(height, 0.5f)));
    const auto picture =
        stage.picture(above(0.3f, 0.5f * height), sphereLight({0, 2, 0}, 0.1f, glm::vec3(10.0f)));
    for (const glm::vec4& pixel : picture) ASSERT_EQ(pixel.r, 0.0f) << "height " << height;
  }
}

TEST_F(LocalShadowsTest, StaysFiniteWhereTheLightTouchesTheSurface) {
  Stage stage(BundleBuilder().add(level(0.0f, 1.0f)));
  for (const float height : {0.0f, 1e-6f, -1e-3f, 0.05f})
    for (const LocalLight::Kind kind : {LocalLight::Kind::Point, LocalLight::Kind::Spot,
                                        LocalLight::Kind::Sphere, LocalLight::Kind::Disc}) {
      // The light is at a pixel's centre.
      LocalLight light = sphereLight({placeOf(32, 0.5f), height, placeOf(32, 0.5f)}, 0.1f, glm::vec3(1e8f));
      light.kind = kind;
      light.direction_ws = {0, -1, 0};
      float most = 0.0f;
      for (const glm::vec4& pixel : stage.picture(above(0.5f), light)) {
        ASSERT_TRUE(pixel.r >= 0.0f && std::isfinite(pixel.r) && pixel.r <= 1e12f);
        most = testing::larger(most, pixel.r);
      }
      if (kind == LocalLight::Kind::Sphere) {
        EXPECT_NEAR(most, 1e8f, 1e5f) << "within a sphere of radiance L, E = pi L";
      }
      if (height == 0.05f) {
        EXPECT_GT(most, 1e6f);
      }
    }
}

TEST_F(LocalShadowsTest, ADrawThatNoLightShinesOnCostsNothingAndChangesNoPixel) {
  Stage stage(BundleBuilder().add(level(0.0f, 1.0f)), {}, /*sky=*/1.0f);
  const LocalLight light = sphereLight({0, 1, 0}, 0.1f, glm::vec3(10.0f));
  const auto plain = stage.picture(above(0.5f), {}, /*plain=*/true);
  EXPECT_GT(plain[0].r, 0.9f);
  const gpu::Counters before = stage.raster;
  stage.masks = {0u};
  EXPECT_EQ(stage.picture(above(0.5f), light), plain);
  EXPECT_FALSE(stage.shadowed_lights.any());
  EXPECT_EQ(stage.shadows.draws, 0u);
  EXPECT_EQ(stage.shadows.uploaded_bytes, 0u);
  EXPECT_LE(stage.raster.draw_calls, before.draw_calls);
  // A dark light, or one that is not in the mask, has no effect.
  stage.masks = {2u};
  EXPECT_EQ(stage.picture(above(0.5f), light), plain);
  stage.masks = {1u};
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (const LocalLight& dark :
       {sphereLight({0, 1, 0}, 0.1f, glm::vec3(0.0f)), sphereLight({0, 1, 0}, 0.0f, glm::vec3(1.0f)),
        sphereLight({0, none, 0}, 0.1f, glm::vec3(1.0f)),
        sphereLight({0, 1, 0}, 0.1f, glm::vec3(std::numeric_limits<float>::infinity()))})
    EXPECT_EQ(stage.picture(above(0.5f), dark), plain);
  EXPECT_EQ(stage.shadows.draws, 0u);
  EXPECT_NE(stage.picture(above(0.5f), light), plain);
  EXPECT_EQ(stage.picture(above(0.5f), std::span<const LocalLight>{}), plain) << "and off again";
}

TEST_F(LocalShadowsTest, DrawsACubeOnlyWhenItsLightOrWhatItSeesMoved) {
  Stage stage(BundleBuilder().add(level(0.0f, 1.0f)).add(level(0.5f, 0.1f)).add(level(0.0f, 0.1f, {50, 0})));
  std::vector<LocalLight> lights = {sphereLight({0, 1, 0}, 0.1f, glm::vec3(10.0f)),
                                    sphereLight({0.3f, 1, 0}, 0.1f, glm::vec3(10.0f))};
  lights[1].kind = LocalLight::Kind::Point;
  lights[1].range_m = 5.0f;
  stage.update(lights);
  EXPECT_EQ(stage.shadowed_lights.cubesDrawn(), 2u);
  EXPECT_GT(stage.shadows.draws, 0u);
  stage.update(lights);
  EXPECT_EQ(stage.shadowed_lights.cubesDrawn(), 0u);
  EXPECT_EQ(stage.shadows.draws + stage.shadows.uploaded_bytes, 0u);
  lights[0].power = glm::vec3(3.0f);
  stage.update(lights);
  EXPECT_EQ(stage.shadowed_lights.cubesDrawn(), 0u) << "brighter, not elsewhere";
  lights[0].position_ws.x += 0.01f;
  stage.update(lights);
  EXPECT_EQ(stage.shadowed_lights.cubesDrawn(), 1u);
  const auto move = [&](std::size_t mesh, float by) {
    for (auto [entity, item] : stage.world.registry().view<const scene::DrawItem>())
      if (item.mesh == mesh) stage.world.registry().edit<scene::Transform>(item.node).translation.y += by;
  };
  move(1, 0.1f);
  stage.update(lights);
  EXPECT_EQ(stage.shadowed_lights.cubesDrawn(), 2u) << "both see it";
  move(2, 0.1f);
  stage.update(lights);
  EXPECT_EQ(stage.shadowed_lights.cubesDrawn(), 1u) << "out of the second's range";
  move(2, 0.0f);
  stage.update(lights);
  EXPECT_EQ(stage.shadowed_lights.cubesDrawn(), 0u) << "touched, but where it was";
}

TEST_F(LocalShadowsTest, MasksLetLightThroughWhereTheirAlphaIsLow) {
  BundleBuilder builder;
  BuiltMesh blocker = level(1.0f, 1.0f);
  // The left half is solid there, the right half is a hole.
  gltf::Sampler nearest{.wrap_s = GL_CLAMP_TO_EDGE,
                        .wrap_t = GL_CLAMP_TO_EDGE,
                        .mag_filter = GL_NEAREST,
                        .min_filter = GL_NEAREST};
  blocker.material.base_color_texture.texture =
      builder.addTexture(2, 1, {255, 255, 255, 255, 255, 255, 255, 0}, nearest);
  blocker.material.alpha_mode = gltf::AlphaMode::Mask;
  Stage stage(builder.add(level(0.0f, 5.0f)).add(blocker));
  LocalLight light = sphereLight({0, 2, 0}, 0.0f, glm::vec3(10.0f));
  light.kind = LocalLight::Kind::Point;
  const auto picture = stage.picture(above(1.0f), light);
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const float at = placeOf(x, 1.0f);
      if (at < -0.02f) {
        ASSERT_EQ(picture[y * kSize + x].r, 0.0f);
      }
      if (at > 0.02f) {
        ASSERT_GT(picture[y * kSize + x].r, 0.3f);
      }
    }
}

TEST_F(LocalShadowsTest, NormalMappedDrawsAndTurnedGroupsAreLitAsPlainOnes) {
  const LocalLight light = sphereLight({0.4f, 1.0f, 0.2f}, 0.2f, glm::vec3(10.0f));
  std::vector<glm::vec4> plain;
  const glm::quat turn = glm::angleAxis(1.1f, glm::normalize(glm::vec3(1, 2, 3)));
  for (const bool normal_mapped : {false, true})
    for (const bool turned : {false, true}) {
      BundleBuilder builder;
      builder.add(level(0.0f, 3.0f)).add(level(0.5f, 0.2f));
      if (normal_mapped)
        builder.normalMapped().transfer([](const glm::vec3&) { return std::vector<float>(81, 0.0f); });
      if (turned) builder.groupRotation(turn);
      Stage stage(builder);
      const auto picture = stage.picture(above(1.0f, 0.4f), light);
      if (plain.empty()) plain = picture;
      // Floats along two ways; a tap may fall to the next texel.
      std::size_t apart = 0;
      for (std::size_t i = 0; i < plain.size(); ++i)
        apart += std::abs(picture[i].r - plain[i].r) > 1e-3f ? 1 : 0;
      EXPECT_LT(apart, plain.size() / 100) << normal_mapped << turned;
    }
}

}  // namespace lambent::frame
