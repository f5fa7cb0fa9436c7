// Tests local lights on glossy surfaces: their highlight and the diffuse part.
#include "baker/brdf/brdf.hpp"
#include "tests/runtime/evaluate/random_table.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/local_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {

using LocalGlossyTest = testing::GpuTest;

TEST_F(LocalGlossyTest, APointLightOnAMetalFloorGivesItsGgxHighlight) {
  constexpr float kRoughness = 0.4f;
  BuiltMesh floor = level(0.0f, 5.0f);
  floor.material.metallic = 1.0f;
  floor.material.roughness = kRoughness;
  Stage stage(BundleBuilder(5).add(floor).glossy(5, bundle::BrdfFamily::Ggx,
                                                 glossy::testing::evenTable(5, true, 0.8f, 0.1f)));
  ShadowedLight point;
  point.kind = ShadowedLight::Kind::Point;
  point.position_ws = {0.4f, 1.0f, -0.3f};
  point.power = {10, 5, 1};
  const auto picture = stage.picture(above(2.0f), point);
  const auto ggx = baker::makeGgx(false);
  float brightest = 0.0f;
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const glm::vec2 at(placeOf(x, 2.0f), placeOf(y, 2.0f));
      const glm::dvec3 to(0.4 - static_cast<double>(at.x), 1.0, -0.3 - static_cast<double>(at.y));
      const double d2 = glm::dot(to, to);
      const glm::dvec3 s = to / std::sqrt(d2);
      std::array<double, 2> f{};
      // The table's frame has its normal along z; the camera looks straight down.
      ggx->value({.roughness = kRoughness, .strength = 0.0f}, {0, 0, 1}, {s.x, s.z, s.y}, f);
      const auto wanted = static_cast<float>((f[0] + f[1]) * 10.0 / d2 * s.y);
      brightest = testing::larger(brightest, wanted);
      ASSERT_NEAR(picture[y * kSize + x].r, wanted, 0.01f * wanted + 1e-3f) << x << ", " << y;
    }
  EXPECT_GT(brightest, 5.0f);
  EXPECT_NEAR(picture[kSize / 2].g, 0.5f * picture[kSize / 2].r, 1e-4f);
}

TEST_F(LocalGlossyTest, ADielectricFloorAddsItsDiffusePart) {
  BuiltMesh floor = level(0.0f, 5.0f, {0, 0}, 0.5f);
  floor.material.metallic = 0.0f;
  floor.material.specular = 0.0f;  // nothing but diffuse is left
  floor.material.roughness = 0.5f;
  Stage stage(BundleBuilder(5).add(floor).glossy(5, bundle::BrdfFamily::Ggx,
                                                 glossy::testing::evenTable(5, true, 0.8f, 0.1f)));
  const auto picture = stage.picture(above(2.0f), sphereLight({0.0f, 1.0f, 0.0f}, 0.2f, {10, 5, 1}));
  for (std::uint32_t x = 0; x < kSize; x += 7) {
    const glm::vec3 to(-placeOf(x, 2.0f), 1.0f, -placeOf(20, 2.0f));
    const float d2 = glm::dot(to, to), wanted = 0.5f * 10.0f * 0.04f / d2 / std::sqrt(d2);
    EXPECT_NEAR(picture[20 * kSize + x].r, wanted, 0.01f * wanted);
  }
}

}  // namespace lambent::frame
