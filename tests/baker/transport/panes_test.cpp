// Light through panes, against products of what their faces pass.
#include "baker/transport/panes.hpp"

#include <cmath>

#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::sceneOf;
using testing::Transport;
using testing::uniformRadiance;

constexpr float kFace = 0.96f;  // of a face with an index of refraction of 1.5

gltf::Material pane() {
  gltf::Material material;
  material.metallic = 0.0f;
  material.roughness = 0.0f;
  material.transmission = 1.0f;
  return material;
}

// Returns E/pi under uniform light, for each channel, in the middle of a floor under a pane that hides the
// sky.
glm::vec3 under(const bundle::MeshData& mesh, const gltf::Material& material) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 2), mesh});
  scene.meshes[1].primitives[0].material = static_cast<std::int32_t>(scene.materials.size());
  scene.materials.push_back(material);
  const Transport t(scene);
  const TransferField field = t.direct();
  const auto vector = field.at(t.sampleAt({0, 0, 0}));
  glm::vec3 seen(0.0f);
  for (std::uint32_t c = 0; c < 3; ++c)
    seen[static_cast<int>(c)] =
        uniformRadiance(vector.subspan((field.channels == 1 ? 0 : c) * field.columns));
  return seen;
}

void expectNear(const glm::vec3& seen, const glm::vec3& expected) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 2e-4f) << c;
}

const bundle::MeshData& thick() {
  static const bundle::MeshData mesh = box({0, 1, 0}, {1e4f, 0.02f, 1e4f}, 1);
  return mesh;
}
bundle::MeshData sheet() {
  return grid({0, 1, 0}, 1e4f, 1);
}

TEST(Panes, OfTwoFacesPassTheLightOfBothAndOfOneSheetThatOfOne) {
  expectNear(under(thick(), pane()), glm::vec3(kFace * kFace));
  expectNear(under(sheet(), pane()), glm::vec3(kFace));
  expectNear(under(flipped(sheet()), pane()), glm::vec3(kFace));
  gltf::Material both = pane();
  both.double_sided = true;
  expectNear(under(sheet(), both), glm::vec3(kFace));
}

TEST(Panes, TintLightByTheirBaseColorAndPassTheShareThatTheyTransmit) {
  gltf::Material material = pane();
  material.base_color = {0.2f, 0.9f, 0.4f, 1.0f};
  material.transmission = 0.5f;
  const glm::vec3 face = 0.5f * kFace * glm::vec3(material.base_color);
  expectNear(under(sheet(), material), face);
  expectNear(under(thick(), material), face * face);
  material.ior = 1.0f;
  expectNear(under(sheet(), material), 0.5f * glm::vec3(material.base_color));
}

TEST(Panes, HaveHolesWhereTheyAreCutOutAndBlendedOnesPassAll) {
  gltf::Material material = pane();
  material.alpha_mode = gltf::AlphaMode::Mask;
  material.base_color.a = 0.25f;
  expectNear(under(sheet(), material), glm::vec3(1.0f));
  material.base_color.a = 0.75f;
  expectNear(under(sheet(), material), glm::vec3(kFace));
  material.alpha_mode = gltf::AlphaMode::Blend;
  expectNear(under(sheet(), material), glm::vec3(1.0f));
}

TEST(Panes, AbsorbOverTheLengthBetweenTheirFacesOrTheirThicknessWhereOneIsMissing) {
  gltf::Material material = pane();
  material.thickness_m = 0.02f;
  material.attenuation_distance_m = 0.04f;
  material.attenuation_color = {0.25f, 0.5f, 1.0f};
  const glm::vec3 half = glm::sqrt(material.attenuation_color);
  expectNear(under(sheet(), material), kFace * half);
  expectNear(under(flipped(sheet()), material), kFace * half);
  Scene scene = sceneOf({thick()});
  scene.materials[0] = material;
  const Transport t(scene);
  for (const float aslant : {0.0f, 1.0f}) {
    const glm::vec3 along = glm::normalize(glm::vec3(aslant, 1, 0));
    const RaySegment ray{{0.3f, 0.0f, 0.2f}, along, 10.0f};
    glm::vec3 passed;
    passedAlong(std::span(&ray, 1), t.rays, t.colors, std::span(&passed, 1));
    expectNear(passed, kFace * kFace * glm::pow(half, glm::vec3(1.0f / along.y)));
  }
}

TEST(Panes, WeakenLampsBehindThem) {
  const auto lamp = [](const bundle::MeshData& mesh, const gltf::Material& material) {
    Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 2), mesh});
    scene.meshes[1].primitives[0].material = 1;
    scene.materials.push_back(material);
    testing::addPointLight(scene, {0, 2, 0});
    const Transport t(scene);
    const TransferField field = t.direct();
    return field.at(t.sampleAt({0, 0, 0}))[field.columns - 1];
  };
  gltf::Material open = pane();
  open.alpha_mode = gltf::AlphaMode::Blend;
  EXPECT_NEAR(lamp(thick(), pane()) / lamp(thick(), open), kFace * kFace, 1e-4f);
}

// What they neither reflect nor transmit is reflected by the base.
TEST(Panes, GainNoLight) {
  Scene scene = sceneOf({sheet()});
  for (const float transmission : {0.0f, 0.3f, 1.0f}) {
    scene.materials[0] = pane();
    scene.materials[0].transmission = transmission;
    const Transport t(scene, /*with_glossy=*/true);
    const glm::vec3 sum = t.colors.albedo(0, 0.3f, 0.3f) + t.colors.passed(0, 0.3f, 0.3f);
    EXPECT_LE(sum.g, 1.0f + 1.0f / 21.0f) << "the layer's mean counts all angles";
    EXPECT_NEAR(t.colors.coverage(0, 0.3f, 0.3f), 1.0f - transmission * kFace, 1e-6f);
  }
}

}  // namespace
}  // namespace lambent::baker
