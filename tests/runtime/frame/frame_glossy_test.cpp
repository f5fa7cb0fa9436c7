// Tests glossy surfaces in whole frames: pictures with known answers, and what they cost.

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/brdf/brdf.hpp"
#include "runtime/frame/frame.hpp"
#include "tests/runtime/frame/ggx_table.hpp"
#include "tests/support/frame/view_stage.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::sphereMesh;

using testing::ggxTable;

gltf::Material metal(const glm::vec3& color, float roughness) {
  gltf::Material material;
  material.base_color = glm::vec4(color, 1.0f);
  material.metallic = 1.0f;
  material.roughness = roughness;
  return material;
}

struct GlossyStage : testing::ViewStage {
  GlossyStage(const BundleBuilder& builder, const std::vector<spec::Light>& lights, bool residual = false)
      : ViewStage(builder, lights, optionsWith(residual), /*load=*/true, {}, 96) {
    camera = {.azimuth_deg = 20.0f, .elevation_deg = 10.0f, .distance_radii = 2.0f, .fov_deg = 40.0f};
  }
  static FrameOptions optionsWith(bool residual) {
    FrameOptions options = testing::linearOptions();
    options.settings.residual = residual;
    options.settings.window = sh::Window::Off;
    return options;
  }
};

// A Hit is where the pixel's ray meets the true sphere of radius 1 about the origin.
struct Hit {
  glm::vec3 normal, to_eye;
  float rim;  // 0 in its middle, 1 at its rim
};
std::optional<Hit> hitSphere(const spec::View& view, const glm::mat4& world_from_clip, std::uint32_t x,
                             std::uint32_t y) {
  const glm::vec2 ndc((2.0f * static_cast<float>(x) + 1.0f) / 96.0f - 1.0f,
                      1.0f - (2.0f * static_cast<float>(y) + 1.0f) / 96.0f);
  const glm::vec4 far = world_from_clip * glm::vec4(ndc, 1.0f, 1.0f);
  const glm::vec3 ray = glm::normalize(far.w != 0.0f ? glm::vec3(far) / far.w - view.eye_ws : glm::vec3(far));
  const float middle = -glm::dot(view.eye_ws, ray);
  const float rim = glm::dot(view.eye_ws, view.eye_ws) - middle * middle;
  if (rim >= 1.0f) return {};
  return Hit{glm::normalize(view.eye_ws + (middle - std::sqrt(1.0f - rim)) * ray), -ray, rim};
}

using testing::kWhite;
const spec::Light kWideSun = spec::SunLight{
    .azimuth_deg = 70, .elevation_deg = 35, .angle_deg = 30, .radiance = glm::vec3(3.0f, 2.5f, 2.0f)};

}  // namespace

using FrameGlossy = testing::GpuTest;

TEST_F(FrameGlossy, AnOpenMetalSphereUnderASunIsWhatTheKernelMakesOfTheLight) {
  const glm::vec3 color(0.9f, 0.6f, 0.3f);
  constexpr float kRoughness = 0.45f;
  BundleBuilder builder(5);
  builder.add({sphereMesh(40, 80), metal(color, kRoughness)})
      .glossy(5, bundle::BrdfFamily::Ggx, ggxTable())
      .groupRotation(glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3))));
  GlossyStage stage(builder, {kWideSun});
  stage.render();
  const spec::RgbaImage image = stage.frame->readLinear();
  const spec::View view = stage.view();
  std::vector<glm::vec4> light;
  for (const glm::vec3& coefficient : stage.environment.light().c) light.emplace_back(coefficient, 0.0f);
  const glossy::glsl::Table table(ggxTable());
  const glm::mat4 world_from_clip = glm::inverse(view.clip_from_view * view.view_from_world);
  double squared = 0.0, power = 0.0;
  std::size_t count = 0;
  for (std::uint32_t y = 0; y < 96; ++y)
    for (std::uint32_t x = 0; x < 96; ++x) {
      const glm::vec4 texel = image.texels[y * 96 + x];
      if (texel.a == 0.0f) continue;
      const std::optional<Hit> hit = hitSphere(view, world_from_clip, x, y);
      if (!hit || hit->rim > 0.97f) continue;  // the mesh's rim
      const auto reflected = table.reflect({hit->normal, {}, hit->to_eye, kRoughness}, light);
      const glm::vec3 expected = color * glm::vec3(reflected.f0_light) + glm::vec3(reflected.f90_light);
      squared += glm::dot(glm::vec3(texel) - expected, glm::vec3(texel) - expected);
      power += glm::dot(expected, expected);
      ++count;
    }
  EXPECT_GT(count, 1500u);
  // Facets of the mesh, normals in 16 bits or so, and b in 16 bits.
  EXPECT_LT(std::sqrt(squared / power), 3e-3);
}

TEST_F(FrameGlossy, UniformLightOnWhiteMetalGivesItsDirectionalAlbedoAndPlasticNeverMoreThanOne) {
  for (const float metallic : {1.0f, 0.0f}) {
    gltf::Material material = metal(glm::vec3(1.0f), 0.5f);
    material.metallic = metallic;
    BundleBuilder builder(5);
    builder.add({sphereMesh(24, 48), material}).glossy(5, bundle::BrdfFamily::Ggx, ggxTable());
    GlossyStage stage(builder, {kWhite});
    stage.render();
    std::size_t count = 0;
    for (const glm::vec4& texel : stage.frame->readLinear().texels) {
      if (texel.a == 0.0f) continue;
      ++count;
      EXPECT_LE(texel.r, 1.0f + 1e-4f);
      if (metallic == 0.0f)
        EXPECT_NEAR(texel.r, 1.0f, 2e-3f) << "what the surface does not reflect the white below does";
      else
        EXPECT_GT(texel.r, 0.75f);
    }
    EXPECT_GT(count, 1000u);
  }
}

TEST_F(FrameGlossy, AMovingCameraUnderStillLightDispatchesNothing) {
  BundleBuilder builder(5);
  builder.add({sphereMesh(12, 24), metal(glm::vec3(1.0f), 0.3f)})
      .glossy(5, bundle::BrdfFamily::Ggx, ggxTable());
  GlossyStage stage(builder, {kWideSun});
  stage.render();
  ASSERT_TRUE(stage.pass("glossy"));
  EXPECT_EQ(stage.pass("glossy")->counters.dispatches, 2u) << "visibility and samples";
  EXPECT_EQ(stage.pass("shade")->counters.dispatches, 0u) << "nothing matte";
  stage.camera.azimuth_deg += 30.0f;
  stage.render();
  stage.frame->timers().finish();
  for (const gpu::PassTime& pass : stage.frame->timers().latest())
    EXPECT_EQ(pass.counters.dispatches, pass.name == "tone map" ? pass.counters.dispatches : 0u) << pass.name;
  EXPECT_EQ(stage.pass("raster")->counters.uploaded_bytes, 0u);
  stage.environment.setTurn(5.0f);
  stage.render();
  EXPECT_EQ(stage.pass("glossy")->counters.dispatches, 2u);
}

TEST_F(FrameGlossy, MeasuredSurfacesShowTheirTable) {
  bundle::BrdfTable table{.order = 4, .lobes = 3, .angles = 3, .values = {}};
  for (std::size_t node = 0; node < 3; ++node)
    for (const float albedo : {0.6f, 0.4f, 0.2f})
      for (std::uint32_t c = 0; c < table.coefficients(); ++c)
        table.values.push_back(c == 0 ? 0.28209479f * albedo : 0.0f);
  gltf::Material material;
  material.brdf = 0;
  BundleBuilder builder(4);
  builder.add({sphereMesh(12, 24), material}).glossy(4, bundle::BrdfFamily::Measured, table);
  GlossyStage stage(builder, {kWhite});
  stage.render();
  for (const glm::vec4& texel : stage.frame->readLinear().texels)
    EXPECT_LT(texel.a * glm::distance(glm::vec3(texel), glm::vec3(0.6f, 0.4f, 0.2f)), 1e-3f);
}

namespace {

// Compares the picture of an unoccluded sphere with the whole integral over the sun: relative RMS error.
double errorUnderASun(float roughness, bool residual, const spec::SunLight& sun) {
  BundleBuilder builder(5);
  builder.add({sphereMesh(40, 80), metal(glm::vec3(1.0f), roughness)})
      .glossy(5, bundle::BrdfFamily::Ggx, ggxTable());
  GlossyStage stage(builder, {sun}, residual);
  stage.render();
  const spec::RgbaImage image = stage.frame->readLinear();
  const spec::View view = stage.view();
  const glm::mat4 world_from_clip = glm::inverse(view.clip_from_view * view.view_from_world);
  const auto ggx = baker::makeGgx(false);
  const lighting::Disc disc = stage.environment.discs()[0];
  const glm::dvec3 centre = disc.direction;
  const glm::dvec3 side = glossy::glsl::Isotropic().perpendicular(disc.direction),
                   up = glm::cross(centre, side);
  const double least = std::cos(static_cast<double>(disc.radius_rad));
  double squared = 0.0, power = 0.0;
  for (std::uint32_t y = 1; y < 96; y += 3)
    for (std::uint32_t x = 1; x < 96; x += 3) {
      const glm::vec4 texel = image.texels[y * 96 + x];
      const std::optional<Hit> hit = hitSphere(view, world_from_clip, x, y);
      if (texel.a == 0.0f || !hit || hit->rim > 0.9f) continue;
      const glm::dvec3 normal = hit->normal, tangent = glossy::glsl::Isotropic().perpendicular(hit->normal);
      const glm::dmat3 local_from_world =
          glm::transpose(glm::dmat3(tangent, glm::cross(normal, tangent), normal));
      const glm::dvec3 to_eye = local_from_world * glm::dvec3(hit->to_eye);
      double expected = 0.0;
      constexpr int kPoints = 4000;
      for (int i = 0; i < kPoints; ++i) {
        const double cosine = 1.0 - (i + 0.5) / kPoints * (1.0 - least);
        const double sine = std::sqrt(1.0 - cosine * cosine), phi = 2.39996323 * i;
        const glm::dvec3 s =
            local_from_world * (cosine * centre + sine * (std::cos(phi) * side + std::sin(phi) * up));
        if (s.z <= 0.0) continue;
        std::array<double, 2> f{};
        ggx->value({.roughness = roughness, .strength = 0.0f}, to_eye, s, f);
        expected += (f[0] + f[1]) * s.z;
      }
      expected *= static_cast<double>(disc.radiance.r) * 2.0 * 3.14159265358979 * (1.0 - least) / kPoints;
      squared += (static_cast<double>(texel.r) - expected) * (static_cast<double>(texel.r) - expected);
      power += expected * expected;
    }
  return std::sqrt(squared / power);
}

}  // namespace

TEST_F(FrameGlossy, TheResidualBringsNarrowHighlightsNearTheWholeIntegral) {
  const spec::SunLight sun{
      .azimuth_deg = 50, .elevation_deg = 35, .angle_deg = 10, .radiance = glm::vec3(10.0f)};
  for (const float roughness : {0.2f, 0.3f, 0.5f}) {
    const double without = errorUnderASun(roughness, false, sun), with = errorUnderASun(roughness, true, sun);
    fmt::print("roughness {:.1f}: relative RMS error {:.3f} in five bands, {:.3f} with the residual\n",
               roughness, without, with);
    EXPECT_LT(with, 0.5 * without);
  }
}

}  // namespace lambent::frame
