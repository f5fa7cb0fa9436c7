#include "baker/brdf/surface_brdfs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/image.hpp"
#include "tests/baker/brdf/quadrature.hpp"
#include "tests/reference/quadrature.hpp"
#include "tests/runtime/sh/sphere.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using lambent::testing::relativeDifference;
using sh::testing::Random;
using testing::kPi;

constexpr int kOrder = sh::kMaxFactoredOrder;  // the sharpest that bakes ask for
constexpr std::size_t kCount = sh::coefficientCount(kOrder);

// Makes a rotated square of one material, whose tangent points along increasing u, and its kernels.
struct Square {
  Scene scene;
  glm::dmat3 turn;  // columns: tangent, bitangent (where v falls), normal
  GroupGeometry geometry;
  std::optional<SurfaceBrdfs> brdfs;

  explicit Square(const gltf::Material& material, unsigned seed = 1, bool with_tangents = false,
                  std::vector<SceneImage> images = {}, std::vector<MeasuredBrdf> measured = {}) {
    bundle::MeshData mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.texcoords0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    Random random(seed);
    turn = glm::mat3_cast(random.rotation());
    for (glm::vec3& p : mesh.positions) p = glm::vec3(turn * glm::dvec3(p));
    mesh.normals.assign(4, glm::vec3(turn[2]));
    if (with_tangents) mesh.tangents.assign(4, glm::vec4(glm::vec3(turn[0]), 1.0f));
    scene = lambent::testing::sceneOf({mesh});
    scene.materials[0] = material;
    scene.images = std::move(images);
    scene.brdfs = std::move(measured);
    for (std::size_t i = 0; i < scene.images.size(); ++i)
      scene.textures.push_back({.image = static_cast<std::int32_t>(i), .sampler = {.mag_filter = 9728}});
    geometry = buildGroupGeometry(findRigidGroups(scene).at(0), scene, {{mesh}}, /*with_glossy=*/true);
    load();
  }

  void load() {
    const gltf::Material& material = scene.materials[0];
    BrdfTables tables;
    tables.of_material = {material.isDiffuse() ? -1 : 0};
    if (!material.isDiffuse()) tables.entries.push_back(material.anisotropy > 0.0f ? brushed() : round());
    if (material.brdf >= 0) {
      auto own = BrdfTables::make(scene, kOrder, kOrder);
      ASSERT_TRUE(own) << own.error().line();
      tables = std::move(*own);
    }
    DecodedImages decoded(scene);
    auto loaded = SurfaceBrdfs::load(scene, geometry, tables, decoded, kOrder);
    ASSERT_TRUE(loaded) << loaded.error().line();
    brdfs.emplace(std::move(*loaded));
  }

  // The tables are integrated once for all squares.
  static const BrdfTables::Entry& round() {
    static const BrdfTables::Entry kEntry{bundle::BrdfFamily::Ggx, "",
                                          integrateTable(*makeGgx(false), kOrder)};
    return kEntry;
  }
  static const BrdfTables::Entry& brushed() {
    static const BrdfTables::Entry kEntry{bundle::BrdfFamily::AnisotropicGgx, "",
                                          integrateTable(*makeGgx(true), kOrder)};
    return kEntry;
  }

  // Takes a direction in the square's frame.
  std::vector<float> kernel(const glm::dvec3& local, float u = 0.3f, float v = 0.3f) const {
    std::vector<float> out(3 * kCount, 77.0f);
    brdfs->exitKernel(0, u, v, glm::vec3(turn * local), out);
    return out;
  }
};

glm::dvec3 direction(double cosine, double phi) {
  const double r = std::sqrt(1 - cosine * cosine);
  return {r * std::cos(phi), r * std::sin(phi), cosine};
}

struct Expected {
  glm::dvec3 f0, base;
  double f90, metal, alpha_t, alpha_b;
  double along = 0;  // of the longer lobe, from the tangent
};

// Integrates c_k from its definition, in the group's frame.
std::vector<double> byQuadrature(const Square& square, const Expected& e, glm::dvec3 v) {
  const double c = std::cos(e.along), s = std::sin(e.along);
  const glm::dmat3 lobe_frame(c, s, 0, -s, c, 0, 0, 0, 1);  // columns: t, b, n in the square's frame
  v = glm::transpose(lobe_frame) * v;
  std::vector<double> parts(2 * kCount + 2), y(kCount);
  const auto nodes = sh::testing::gaussLegendre(200, 0, kPi / 2);
  constexpr int kTurns = 500;
  for (const auto& theta : nodes)
    for (int k = 0; k < kTurns; ++k) {
      const double phi = 2 * kPi * (k + 0.5) / kTurns, r = std::sin(theta.at);
      const glm::dvec3 light(r * std::cos(phi), r * std::sin(phi), std::cos(theta.at));
      const double weight = theta.weight * r * 2 * kPi / kTurns;
      const glm::dvec2 lobes = weight * light.z * lambent::testing::Ggx{e.alpha_t, e.alpha_b}.value(v, light);
      const double zero = lobes.x, one = lobes.y;
      sh::evaluate(kOrder, square.turn * (lobe_frame * light), y);
      for (std::size_t i = 0; i < kCount; ++i) parts[i] += zero * y[i], parts[kCount + i] += one * y[i];
      parts[2 * kCount] += zero, parts[2 * kCount + 1] += one;
    }
  const glm::dvec3 rho = e.f0 * parts[2 * kCount] + e.f90 * parts[2 * kCount + 1];
  const glm::dvec3 diffuse = (1 - e.metal) * (1 - std::max({rho.r, rho.g, rho.b})) * e.base;
  std::vector<double> cosine(kCount), out;
  sh::unoccludedTransfer(kOrder, square.turn[2], cosine);
  for (int channel = 0; channel < 3; ++channel)
    for (std::size_t i = 0; i < kCount; ++i)
      out.push_back(e.f0[channel] * parts[i] + e.f90 * parts[kCount + i] + diffuse[channel] * cosine[i]);
  return out;
}

// Returns the reflection of uniform light of radiance 1, in one channel.
double reflected(const std::vector<float>& kernel, std::size_t channel) {
  return 2 * std::sqrt(kPi) * static_cast<double>(kernel[channel * kCount]);
}

gltf::Material materialOf(glm::vec3 color, float metallic, float roughness) {
  gltf::Material material;
  material.base_color = glm::vec4(color, 1.0f);
  material.metallic = metallic;
  material.roughness = roughness;
  return material;
}

const std::array<double, 5> kViewCosines = {0.02, 0.1, 0.35, 0.7, 0.98};

TEST(SurfaceBrdfs, FollowTheConventionsFormulaOfMetalsAndDielectrics) {
  gltf::Material mixed = materialOf({0.8f, 0.4f, 0.1f}, 0.3f, 0.61f);
  mixed.ior = 1.8f;
  mixed.specular = 0.7f;
  mixed.specular_color = {1.0f, 0.5f, 3.0f};
  const double step = 0.8 / 2.8 * 0.8 / 2.8;
  const glm::dvec3 dielectric = 0.7 * glm::dvec3(step, 0.5 * step, 3 * step);
  const struct {
    gltf::Material material;
    Expected expected;
  } cases[] = {
      {materialOf({0.9f, 0.6f, 0.3f}, 1.0f, 0.5f), {{0.9, 0.6, 0.3}, {0.9, 0.6, 0.3}, 1, 1, 0.25, 0.25}},
      {materialOf({0.9f, 0.6f, 0.3f}, 0.0f, 0.5f), {glm::dvec3(0.04), {0.9, 0.6, 0.3}, 1, 0, 0.25, 0.25}},
      {mixed,
       {glm::mix(dielectric, glm::dvec3(0.8, 0.4, 0.1), 0.3),
        {0.8, 0.4, 0.1},
        0.3 + 0.7 * 0.7,
        0.3,
        0.3721,
        0.3721}}};
  unsigned seed = 5;
  for (const auto& [material, expected] : cases) {
    const Square square(material, ++seed);
    ASSERT_TRUE(square.brdfs->glossy(0));
    EXPECT_FALSE(square.brdfs->grey());
    for (const double cosine : kViewCosines)
      for (const double phi : {0.3, 2.2, 4.4}) {
        const glm::dvec3 v = direction(cosine, phi);
        EXPECT_LT(relativeDifference(square.kernel(v), byQuadrature(square, expected, v)), 0.005)
            << "metallic " << material.metallic << ", cos " << cosine << ", phi " << phi;
      }
  }
}

// Stored tangents and texture coordinates agree here; the rotation goes from the tangent to the bitangent.
TEST(SurfaceBrdfs, TurnAnisotropicLobesWithTangentAndRotation) {
  gltf::Material material = materialOf({0.9f, 0.9f, 0.9f}, 1.0f, 0.6f);
  material.anisotropy = 0.7f;
  material.anisotropy_rotation_rad = 0.5f;
  const double alpha_t = 0.36 + (1 - 0.36) * 0.49;
  const Expected expected{glm::dvec3(0.9), glm::dvec3(0.9), 1, 1, alpha_t, 0.36, 0.5};
  const Square stored(material, 3, /*with_tangents=*/true), derived(material, 3);
  EXPECT_TRUE(stored.brdfs->grey());
  for (const double cosine : kViewCosines)
    for (const double phi : {0.3, 1.1, 2.2, 3.9, 5.5}) {
      const glm::dvec3 v = direction(cosine, phi);
      const auto kernel = stored.kernel(v);
      EXPECT_LT(relativeDifference(kernel, byQuadrature(stored, expected, v)), 0.01)
          << "cos " << cosine << ", phi " << phi;
      EXPECT_LT(relativeDifference(derived.kernel(v), kernel), 1e-4);
    }
}

TEST(SurfaceBrdfs, OfMatteSurfacesAreLamberts) {
  gltf::Material matte = materialOf({0.7f, 0.5f, 0.2f}, 0.0f, 1.0f);
  const Square square(matte);
  EXPECT_FALSE(square.brdfs->glossy(0));
  std::vector<double> cosine(kCount);
  sh::unoccludedTransfer(kOrder, square.turn[2], cosine);
  const auto kernel = square.kernel(direction(0.4, 1.0));
  for (std::size_t i = 0; i < kCount; ++i) {
    EXPECT_NEAR(kernel[i], 0.7 * cosine[i], 1e-6);
    EXPECT_NEAR(kernel[2 * kCount + i], 0.2 * cosine[i], 1e-6);
  }
}

TEST(SurfaceBrdfs, NeverSendOutMoreThanUniformLightBrings) {
  Random random(17);
  for (int trial = 0; trial < 25; ++trial) {
    gltf::Material material =
        materialOf({1.0f, 1.0f, 1.0f}, trial % 3 == 0 ? 1.0f : static_cast<float>(random.uniform()),
                   static_cast<float>(random.uniform()));
    material.ior = trial % 5 == 0 ? 0.0f : 1.0f + 2.0f * static_cast<float>(random.uniform());
    material.specular_color = glm::vec3(3.0f);
    const Square square(material, static_cast<unsigned>(trial));
    for (int k = 0; k < 40; ++k) {
      const auto kernel = square.kernel(direction(std::pow(random.uniform(), 2.0), 6.28 * random.uniform()));
      for (std::size_t channel = 0; channel < 3; ++channel) {
        EXPECT_LE(reflected(kernel, channel), 1.0 + 1e-4);
        EXPECT_GE(reflected(kernel, channel), 0.0);
      }
      for (const float c : kernel) EXPECT_TRUE(std::isfinite(c));
    }
  }
}

TEST(SurfaceBrdfs, SendNothingBackwardsAndStayFiniteAtTheEdge) {
  gltf::Material material = materialOf({1.0f, 1.0f, 1.0f}, 1.0f, 0.0f);
  for (const float strength : {0.0f, 1.0f}) {
    material.anisotropy = strength;
    const Square square(material);
    for (const float c : square.kernel({0.6, 0.0, -0.8})) EXPECT_EQ(c, 0.0f);
    for (const double cosine : {1e-3, 1e-5, 1e-7, 1.0})
      for (const float c : square.kernel(direction(cosine, 0.5))) EXPECT_TRUE(std::isfinite(c));
  }
}

// A view below the plane of a bent normal, but above the triangle, is treated as 0.001 above that plane.
TEST(SurfaceBrdfs, LiftViewsBelowTheShadingPlane) {
  Square square(materialOf({0.9f, 0.9f, 0.9f}, 1.0f, 0.5f));
  const glm::dvec3 bent = glm::normalize(glm::dvec3(-0.8, 0, 1));
  square.geometry.normals.assign(4, glm::vec3(square.turn * bent));
  const glm::dvec3 below = direction(0.1, 0.0);
  ASSERT_LT(glm::dot(bent, below), 0.0);
  const glm::dvec3 along = glm::normalize(below - glm::dot(bent, below) * bent);
  const auto found = square.kernel(below), edge = square.kernel(glm::normalize(along + 1e-3 * bent));
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], edge[i], 1e-4);
}

// The texture has 2 x 2 texels: red, green / blue, (188, 188, 188) with alpha 128.
SceneImage fourTexels() {
  const std::vector<std::uint8_t> png =
      spec::encodePng({2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 188, 188, 188, 128}});
  SceneImage image{.name = "four", .mime_type = "image/png", .file_bytes = {}};
  for (const std::uint8_t byte : png) image.file_bytes.push_back(std::byte{byte});
  return image;
}

// Compares every texture with the texel's value as a factor, at the texel (188, 188, 188, 128), which is at
// uv (0.75, 0.75): barycentric 0.5, 0.25 of the first triangle. Colours are sRGB, data are not.
TEST(SurfaceBrdfs, LookUpEachTextureAsWhatItIs) {
  constexpr float kData = 188.0f / 255.0f, kAlpha = 128.0f / 255.0f;
  const float color = std::pow((kData + 0.055f) / 1.055f, 2.4f);
  gltf::Material plain = materialOf({0.9f, 0.7f, 0.5f}, 0.6f, 0.8f);
  plain.anisotropy = 0.5f;
  const gltf::TextureRef ref{.texture = 0};
  const struct {
    const char* name;
    gltf::TextureRef gltf::Material::*texture;
    std::function<void(gltf::Material&)> same;
  } cases[] = {
      {"base color", &gltf::Material::base_color_texture,
       [&](gltf::Material& m) { m.base_color *= glm::vec4(color, color, color, kAlpha); }},
      {"metallic roughness", &gltf::Material::metallic_roughness_texture,
       [&](gltf::Material& m) { m.metallic *= kData, m.roughness *= kData; }},
      {"specular", &gltf::Material::specular_texture, [&](gltf::Material& m) { m.specular *= kAlpha; }},
      {"specular color", &gltf::Material::specular_color_texture,
       [&](gltf::Material& m) { m.specular_color *= color; }},
      {"anisotropy", &gltf::Material::anisotropy_texture, [&](gltf::Material& m) {
         // Equal red and green mean the direction half way from the tangent to the bitangent.
         m.anisotropy *= kData, m.anisotropy_rotation_rad += static_cast<float>(kPi) / 4;
       }}};
  for (const auto& one : cases) {
    gltf::Material textured = plain, factored = plain;
    textured.*one.texture = ref;
    one.same(factored);
    const Square a(textured, 4, false, {fourTexels()}), b(factored, 4), untouched(plain, 4);
    const glm::dvec3 v = direction(0.4, 0.9);
    const auto found = a.kernel(v, 0.5f, 0.25f), expected = b.kernel(v), without = untouched.kernel(v);
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_NEAR(found[i], expected[i], 1e-5) << one.name << ": " << i;
    EXPECT_GT(relativeDifference(found, without), 1e-3) << one.name << " changes nothing";
  }
}

TEST(SurfaceBrdfs, OfVertexColorsTintMetals) {
  Square square(materialOf({1.0f, 1.0f, 1.0f}, 1.0f, 0.5f));
  const glm::dvec3 v = direction(0.5, 0.2);
  const auto white = square.kernel(v);
  square.geometry.colors.assign(4, glm::vec4(1.0f, 0.5f, 0.0f, 1.0f));
  square.load();
  const auto tinted = square.kernel(v);
  EXPECT_FALSE(square.brdfs->grey());
  EXPECT_NEAR(reflected(tinted, 0), reflected(white, 0), 1e-6);
  EXPECT_LT(reflected(tinted, 1), 0.56 * reflected(white, 1));
  EXPECT_LT(reflected(tinted, 2), 0.1);
}

TEST(SurfaceBrdfs, ShareOneTableOfEachKind) {
  Scene scene = Square(materialOf({1, 1, 1}, 1.0f, 0.5f)).scene;
  gltf::Material brushed = scene.materials[0];
  brushed.anisotropy = 0.4f;
  scene.materials = {materialOf({1, 1, 1}, 0.0f, 1.0f), materialOf({1, 0, 0}, 1.0f, 0.2f),
                     materialOf({1, 1, 0}, 0.0f, 0.7f), brushed, brushed};
  const auto tables = BrdfTables::make(scene, 4, 4);
  ASSERT_TRUE(tables);
  EXPECT_EQ(tables->of_material, (std::vector<std::int32_t>{-1, 0, 0, 1, 1}));
  ASSERT_EQ(tables->entries.size(), 2u);
  EXPECT_EQ(tables->entries[0].family, bundle::BrdfFamily::Ggx);
  EXPECT_TRUE(tables->entries[0].table.isotropic());
  EXPECT_EQ(tables->entries[1].family, bundle::BrdfFamily::AnisotropicGgx);
  EXPECT_EQ(tables->entries[1].table.order, 4u);

  scene.materials.resize(1);
  const auto none = BrdfTables::make(scene, 4, 4);
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->entries.empty());
}

}  // namespace
}  // namespace lambent::baker
