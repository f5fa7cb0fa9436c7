// Tests smooth dielectrics in whole frames: pictures with known answers, and the shader against its text as
// C++.
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/brdf/brdf.hpp"
#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/frame/ggx_table.hpp"
#include "tests/support/frame/view_stage.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;

constexpr std::uint32_t kSide = 64;
constexpr int kOrder = 5;
using Vector = std::array<float, transfer::kSeenCoefficients>;

using testing::ggxTable;

gltf::Material plastic(const glm::vec3& color, float roughness) {
  gltf::Material material;
  material.base_color = glm::vec4(color, 1.0f);
  material.metallic = 0.0f;
  material.roughness = roughness;
  return material;
}

// Returns transfer without bounces of a surface that sees the sky where `sees` says so, by quadrature.
template <class Sees>
Vector transferOf(const glm::vec3& normal, const Sees& sees) {
  constexpr int kHeights = 100, kAzimuths = 200;
  constexpr float kPi = std::numbers::pi_v<float>;
  Vector sum{};
  for (int i = 0; i < kHeights; ++i)
    for (int j = 0; j < kAzimuths; ++j) {
      const float z = 2.0f * (static_cast<float>(i) + 0.5f) / kHeights - 1.0f;
      const float phi = 2.0f * kPi * (static_cast<float>(j) + 0.5f) / kAzimuths;
      const float r = std::sqrt(1.0f - z * z);
      const glm::vec3 s(r * std::cos(phi), r * std::sin(phi), z);
      const float cosine = glm::dot(s, normal);
      if (cosine <= 0.0f || !sees(s)) continue;
      Vector y;
      sh::evaluate(kOrder, s, y);
      for (std::size_t k = 0; k < y.size(); ++k)
        sum[k] += 4.0f / (kHeights * kAzimuths) * cosine * y[k];  // 4 pi / N over pi
    }
  return sum;
}

bool openTowardsX(const glm::vec3& s) {
  return s.x > 0.0f;
}

std::vector<float> listOf(const Vector& vector) {
  return {vector.begin(), vector.end()};
}

// Renders a bundle under uniform white light.
spec::RgbaImage pictureOf(const BundleBuilder& builder, const spec::OrbitCamera& camera,
                          spec::View* seen = nullptr) {
  testing::ViewStage stage(builder, {testing::kWhite}, testing::linearOptions());
  stage.camera = camera;
  if (seen) *seen = stage.view();
  return stage.picture();
}

// Looks the weights of the kernel up as the GPU does.
std::vector<float> seenWeights(const evaluate::SeenKernel& kernel, float cosine, float roughness) {
  const glm::vec2 nodes(evaluate::kSeenCosines, evaluate::kSeenRoughnesses);
  const glm::vec2 place = glm::vec2(bundle::angleAxis(cosine), roughness) * (nodes - 1.0f);
  const glm::vec2 low = glm::min(glm::floor(place), nodes - 2.0f), part = place - low;
  std::vector<float> weights;
  for (std::uint32_t layer = 0; layer < evaluate::kSeenLayers; ++layer) {
    const auto at = [&](float x, float y) {
      return kernel.texels[(layer * evaluate::kSeenRoughnesses + static_cast<std::size_t>(y)) *
                               evaluate::kSeenCosines +
                           static_cast<std::size_t>(x)];
    };
    const glm::vec4 four =
        glm::mix(glm::mix(at(low.x, low.y), at(low.x + 1.0f, low.y), part.x),
                 glm::mix(at(low.x, low.y + 1.0f), at(low.x + 1.0f, low.y + 1.0f), part.x), part.y);
    for (int i = 0; i < 4; ++i) weights.push_back(four[i]);
  }
  return weights;
}

float seenAbout(Vector seen, const glm::vec3& normal, const glm::vec3& mirrored, float roughness) {
  static const evaluate::SeenKernel kernel = evaluate::makeSeenKernel();
  const sh::ZonalFactors factors(static_cast<int>(transfer::kSeenBands), /*isotropic=*/true);
  std::vector<glm::vec3> axes(factors.axes().begin(), factors.axes().end());
  const auto view = glossy::glsl::Isotropic().localView(normal, {}, mirrored);
  return transfer::glsl::SeenSky().seenShare(
      seen.data(), seenWeights(kernel, view.cos_theta, roughness).data(), axes.data(),
      glm::mat3(view.tangent, view.bitangent, view.normal));
}

}  // namespace

TEST(SeenKernel, SeesAllOfAnOpenSkyInEveryDirection) {
  const Vector open = transferOf({0, 0, 1}, [](const glm::vec3&) { return true; });
  for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f})
    for (const float cosine : {0.05f, 0.3f, 0.7f, 1.0f})
      EXPECT_NEAR(seenAbout(open, {0, 0, 1}, {std::sqrt(1.0f - cosine * cosine), 0.0f, cosine}, roughness),
                  1.0f, 0.01f)
          << roughness << " " << cosine;
}

TEST(SeenKernel, TellsTheOpenSideFromTheOther) {
  const Vector half = transferOf({0, 0, 1}, openTowardsX);
  for (const float elevation : {0.2f, 0.5f, 0.8f}) {  // radians; few bands blur the edge above
    const glm::vec3 towards(std::cos(elevation), 0.0f, std::sin(elevation));
    EXPECT_GT(seenAbout(half, {0, 0, 1}, towards, 0.2f), 0.85f) << elevation;
    EXPECT_LT(seenAbout(half, {0, 0, 1}, {-towards.x, 0.0f, towards.z}, 0.2f), 0.15f) << elevation;
  }
}

using FrameLayered = testing::GpuTest;

TEST_F(FrameLayered, AWhiteSphereInAWhiteFurnaceIsWhiteHoweverSmooth) {
  for (const float roughness : {0.0f, 0.3f, 0.45f}) {
    BundleBuilder builder(kOrder);
    builder.add({testing::sphereMesh(40, 80), plastic(glm::vec3(1.0f), roughness)}).layered(ggxTable());
    const spec::RgbaImage image = pictureOf(builder, {.azimuth_deg = 20.0f, .elevation_deg = 10.0f});
    std::size_t count = 0;
    for (const glm::vec4& texel : image.texels) {
      if (texel.a < 1.0f) continue;
      ++count;
      // The weights of the mirror are interpolated, and facets of the rim mirror what is below their horizon.
      ASSERT_NEAR(texel.g, 1.0f, 0.01f) << roughness;
    }
    EXPECT_GT(count, 500u);
  }
}

TEST_F(FrameLayered, AMirrorInTheDarkDoesNotShowTheSky) {
  BundleBuilder builder(kOrder);
  builder.add({testing::quadMesh(), plastic(glm::vec3(0.5f), 0.1f)}).layered(ggxTable());
  builder.transfer([](const glm::vec3&) { return std::vector<float>(kOrder * kOrder, 0.0f); });
  const spec::RgbaImage image = pictureOf(builder, {.azimuth_deg = 0.0f, .elevation_deg = 0.0f});
  const glm::vec4 middle = image.texels[kSide * kSide / 2 + kSide / 2];
  EXPECT_EQ(middle.a, 1.0f);
  EXPECT_LT(middle.g, 1e-4f) << "the quad covers the picture's middle";
}

TEST_F(FrameLayered, AMirrorBesideAWallShowsWhatTheTwinSaysWithANormalMapOrWithout) {
  const float roughness = 0.3f;
  Vector half = transferOf({0, 0, 1}, openTowardsX);
  const glossy::glsl::Table table(ggxTable());
  const float open = transfer::glsl::SeenSky().seenShareOfAll(half.data());
  EXPECT_NEAR(open, 0.5f, 0.01f);
  for (const bool mapped : {false, true})
    for (const float azimuth : {-50.0f, 50.0f}) {
      BundleBuilder builder(kOrder);
      builder.add({testing::quadMesh(), plastic(glm::vec3(0.0f), roughness)}).layered(ggxTable());
      builder.transfer([&](const glm::vec3&) {
        std::vector<float> out = listOf(half);
        if (!mapped) return out;
        // E/pi at any normal is 0.282 times the first of nine outputs, if the others are 0.
        for (float& value : out) value /= 0.28209479f;
        out.resize(9 * out.size(), 0.0f);
        return out;
      });
      if (mapped) builder.normalMapped();
      spec::View view;
      const spec::RgbaImage image =
          pictureOf(builder, {.azimuth_deg = azimuth, .elevation_deg = 0.0f, .distance_radii = 4.0f}, &view);
      const glm::vec4 middle = image.texels[(kSide / 2) * kSide + kSide / 2];
      ASSERT_EQ(middle.a, 1.0f);
      const glm::vec3 to_eye = glm::normalize(view.eye_ws);
      const glm::vec3 mirrored(-to_eye.x, -to_eye.y, to_eye.z);
      const glm::vec3 lobes =
          table.reflect({{0, 0, 1}, {}, to_eye, roughness}, std::vector<glm::vec4>(25)).albedo;
      const float albedo = 0.04f * lobes.x + lobes.y;
      const float share = seenAbout(half, {0, 0, 1}, mirrored, roughness);
      // E/pi is all from the sky, so a tenth of it stays for what hides the rest.
      const float hidden = 0.1f * open / (1.0f - open);
      // The pixel's middle is not the ray of `to_eye`, and coefficients are half floats.
      EXPECT_NEAR(middle.g, albedo * (share + (1.0f - share) * hidden), 0.02f * albedo)
          << azimuth << (mapped ? " mapped" : "");
      EXPECT_EQ(mirrored.x > 0.0f, middle.g > 0.5f * albedo);
    }
}

}  // namespace lambent::frame
