// Tests which surfaces go without matrices, and how much of the light they send on.
#include "baker/plan/smooth_dielectrics.hpp"

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

gltf::Material dielectric(float roughness) {
  gltf::Material material;
  material.metallic = 0.0f;
  material.roughness = roughness;
  return material;
}

TEST(SmoothDielectrics, AreThoseOfWhoseHighlightsFiveBandsCarryLessThanNineTenths) {
  EXPECT_TRUE(isSmoothDielectric(dielectric(0.0f)));
  EXPECT_TRUE(isSmoothDielectric(dielectric(0.45f)));
  EXPECT_FALSE(isSmoothDielectric(dielectric(0.5f))) << "91.8 %";
  EXPECT_TRUE(hasMatrices(dielectric(0.5f)));
  EXPECT_FALSE(hasMatrices(dielectric(0.45f)));
  EXPECT_FALSE(hasMatrices(dielectric(1.0f))) << "a diffuse surface";
  EXPECT_FALSE(isSmoothDielectric(dielectric(1.0f)));
}

TEST(SmoothDielectrics, AreNoMetalsAndHaveNoDirectionNoTexturesOfTheLayerAndLittleReflection) {
  gltf::Material material = dielectric(0.2f);
  material.metallic_roughness_texture.texture = 0;
  EXPECT_TRUE(isSmoothDielectric(material)) << "a texture makes it only smoother";
  const auto other = [&](auto change) {
    gltf::Material changed = dielectric(0.2f);
    change(changed);
    EXPECT_FALSE(isSmoothDielectric(changed));
    EXPECT_TRUE(hasMatrices(changed));
  };
  other([](gltf::Material& m) { m.metallic = 0.5f; });
  other([](gltf::Material& m) { m.anisotropy = 0.5f; });
  other([](gltf::Material& m) { m.brdf = 0; });
  other([](gltf::Material& m) { m.specular_texture.texture = 0; });
  other([](gltf::Material& m) { m.specular_color_texture.texture = 0; });
  other([](gltf::Material& m) { m.ior = 2.4f; });
}

TEST(SmoothDielectrics, SendOnAllLightIfTheirBaseIsWhiteAndWhatTheLayerReflectsIfItIsBlack) {
  const glm::vec3 layer = meanSpecularAlbedo(dielectric(0.2f));
  EXPECT_NEAR(layer.r, 0.04f + 0.96f / 21.0f, 1e-5f) << "the mean of Schlick's Fresnel term";
  EXPECT_NEAR(albedoUnderLayer(glm::vec3(1.0f), layer).g, 1.0f, 1e-6f);
  EXPECT_EQ(albedoUnderLayer(glm::vec3(0.0f), layer), layer);
  EXPECT_EQ(albedoUnderLayer(glm::vec3(0.3f), glm::vec3(0.0f)), glm::vec3(0.3f));
}

}  // namespace
}  // namespace lambent::baker
