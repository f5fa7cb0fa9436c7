// Compares baker and reference for the same materials, which each evaluates by its own code: interpolated and
// rotated tables of b(v) on one side, directions sampled at the point on the other. Their exit kernels must
// agree, also with textures and tangents.
#include <gtest/gtest.h>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "reference/exit_kernel.hpp"
#include "reference/sampler.hpp"
#include "runtime/spec/image.hpp"
#include "tests/reference/measure.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::baker::reference {
namespace {

constexpr int kOrder = 5;

// Makes 4 x 4 texels of which every channel differs, read without filtering, as the baker reads them.
gltf::TextureRef noise(Scene& scene, std::uint32_t seed) {
  spec::Rgba8Image image{4, 4, {}};
  for (std::uint32_t i = 0; i < 64; ++i)
    image.texels.push_back(static_cast<std::uint8_t>(hash32(seed + i) % 200 + 40));
  return testing::addTexture(scene, image);
}

// Makes a sheet with tilted normals and oblique tangents.
Scene sheet() {
  Scene scene = testing::sceneOf({testing::grid({0, 0, 0}, 2.0f, 3)});
  auto& mesh = scene.meshes[0].primitives[0].mesh;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::vec3 p = mesh.positions[v];
    mesh.normals[v] = glm::normalize(glm::vec3(0.3f * p.x, 1.0f, -0.2f * p.z));
    const glm::vec3 along = glm::vec3(1.0f, 0.0f, 0.4f * p.x);
    mesh.tangents.emplace_back(glm::normalize(along - glm::dot(along, mesh.normals[v]) * mesh.normals[v]),
                               1.0f);
    mesh.colors.emplace_back(0.5f + 0.2f * p.x, 0.8f, 0.6f, 1.0f);
  }
  return scene;
}

// Returns the largest difference of the two kernels over places and views, relative to the reference.
double apart(const Scene& scene) {
  const auto surfaces = Surfaces::build(scene);
  const RigidGroup group = findRigidGroups(scene).at(0);
  DecodedImages images(scene);
  const GroupGeometry geometry =
      buildGroupGeometry(group, scene, {{scene.meshes[0].primitives[0].mesh}}, /*with_glossy=*/true);
  const auto tables = BrdfTables::make(scene, kOrder, kOrder);
  EXPECT_TRUE(tables) << (tables ? "" : tables.error().line());
  const auto brdfs = SurfaceBrdfs::load(scene, geometry, *tables, images, kOrder);
  EXPECT_TRUE(brdfs);
  double worst = 0.0;
  for (std::uint32_t i = 0; i < geometry.triangles.size(); i += 5) {
    const Hit hit{.surface = 0, .triangle = i, .u = 0.2f, .v = 0.5f, .t = 1.0f};
    EXPECT_EQ(geometry.triangles[i], surfaces->triangles()[i]);
    for (int k = 0; k < 6; ++k) {
      const float cosine = std::max(0.01f, 1.0f - 0.2f * static_cast<float>(k)),
                  side = std::sqrt(1.0f - cosine * cosine);
      const float azimuth = 1.3f * static_cast<float>(k) + 0.7f * static_cast<float>(i);
      const glm::vec3 to = frameAbout(surfaces->pointAt(hit, {0, -1, 0}).shading) *
                           glm::vec3(side * std::cos(azimuth), side * std::sin(azimuth), cosine);
      const SurfacePoint point = surfaces->pointAt(hit, -to);
      if (point.blocked) continue;
      const sh::LightVector own = exitKernel(point, kOrder, 7 * i + static_cast<std::uint32_t>(k), 2048);
      std::array<float, 3 * kOrder * kOrder> other{};
      brdfs->exitKernel(i, hit.u, hit.v, to, other);
      double away = 0.0, all = 0.0;
      for (std::size_t j = 0; j < kOrder * kOrder; ++j)
        for (int c = 0; c < 3; ++c) {
          const double a = double{own.c[j][c]},
                       b = double{other[static_cast<std::size_t>(c) * kOrder * kOrder + j]};
          away += (a - b) * (a - b);
          all += a * a;
        }
      worst = testing::larger(worst, std::sqrt(away / all));
    }
  }
  return worst;
}

TEST(KernelTwins, AgreeOnMetalsAndDielectrics) {
  for (const auto& [metallic, roughness] : {std::pair{0.0f, 0.5f}, {0.4f, 0.1f}, {1.0f, 0.7f}}) {
    Scene scene = sheet();
    scene.materials[0].metallic = metallic;
    scene.materials[0].roughness = roughness;
    scene.materials[0].ior = 1.8f;
    scene.materials[0].specular_color = {1.0f, 0.5f, 3.0f};
    scene.materials[0].specular = 0.8f;
    EXPECT_LT(apart(scene), 0.008) << metallic << " " << roughness;
  }
}

// The table's nodes are further apart in azimuth and strength than in the others. The first view of each
// place is along the normal, where the azimuth is only rounding.
TEST(KernelTwins, AgreeOnAnisotropyAndTextures) {
  Scene scene = sheet();
  gltf::Material& m = scene.materials[0];
  m.metallic = 0.8f;
  m.anisotropy = 0.5f;
  m.anisotropy_rotation_rad = 0.6f;
  m.base_color_texture = noise(scene, 1);
  m.metallic_roughness_texture = noise(scene, 2);
  m.specular_texture = noise(scene, 3);
  m.specular_color_texture = noise(scene, 4);
  m.anisotropy_texture = noise(scene, 5);
  m.metallic_roughness_texture.scale = {1.7f, 0.6f};
  m.anisotropy_texture.rotation_rad = 0.4f;
  EXPECT_LT(apart(scene), 0.03);
}

TEST(KernelTwins, AgreeOnMeasurements) {
  LAMBENT_NEEDS_SHARED(testing::sharedFile("brdf"));
  for (const float scale : {1.0f, 20.0f}) {  // and where both must hold back
    Scene scene = sheet();
    scene.brdfs = {*readMeasuredBrdf(testing::sharedFile("brdf/garnet_red.brdf"))};
    for (BrdfMeasurement& m : scene.brdfs[0].measurements) m.value *= scale;
    scene.materials[0].brdf = 0;
    EXPECT_LT(apart(scene), 0.015) << scale;
  }
}

}  // namespace
}  // namespace lambent::baker::reference
