// Compares pictures through panes (KHR_materials_transmission) with closed forms.
#include <gtest/gtest.h>

#include "tests/reference/measure.hpp"

namespace lambent::baker::reference {
namespace {

using testing::expectMean;
using testing::measured;
using testing::samples;
using testing::sceneOf;
using testing::uniform;

constexpr double kFace = 0.96;  // of a face with an index of refraction of 1.5

gltf::Material pane() {
  gltf::Material material = testing::matte();
  material.roughness = 0.0f;
  material.transmission = 1.0f;
  return material;
}

// Makes a white floor under a pane.
Scene floorUnder(const bundle::MeshData& mesh, const gltf::Material& material) {
  Scene scene = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1), mesh});
  testing::paint(scene, 1, material);
  return scene;
}

const bundle::MeshData& thick() {
  static const bundle::MeshData mesh = testing::box({0, 1, 0}, {1e4f, 0.02f, 1e4f}, 1);
  return mesh;
}

TEST(ReferencePanes, PassTheSkyToTheFloorUnderThem) {
  const auto seen = [](const Scene& scene) {
    return measured(scene, {0, 0.9f, 0.1f}, {0, 0, 0}, {uniform(1.0f)}, samples(64, 0));
  };
  expectMean(seen(floorUnder(thick(), pane())), kFace * kFace);
  const bundle::MeshData sheet = testing::grid({0, 1, 0}, 1e4f, 1);
  for (const auto& mesh : {sheet, testing::flipped(sheet)}) expectMean(seen(floorUnder(mesh, pane())), kFace);
  gltf::Material half = pane();
  half.transmission = 0.5f;
  half.base_color = {1.0f, 0.8f, 1.0f, 1.0f};
  half.thickness_m = half.attenuation_distance_m = 0.1f;
  half.attenuation_color = {1.0f, 0.5f, 1.0f};
  expectMean(seen(floorUnder(sheet, half)), 0.5 * 0.8 * 0.5 * kFace);
}

TEST(ReferencePanes, PassASunAndLetTheEyeThrough) {
  const spec::Light sun = spec::SunLight{.elevation_deg = 90, .angle_deg = 1, .radiance = glm::vec3(1000)};
  const double radiance = 1000.0 * std::pow(std::sin(glm::radians(1.0)), 2.0);
  const Scene scene = floorUnder(thick(), pane());
  expectMean(measured(scene, {0, 0.9f, 0.1f}, {0, 0, 0}, {sun}, samples(64, 0)), kFace * kFace * radiance,
             1e-4);
  // The eye sees through the front face, whose mirror shows the dark beside the sun.
  expectMean(measured(scene, {1.0f, 3, 0}, {0, 0, 0}, {sun}, samples(64, 0)),
             kFace * kFace * kFace * radiance, 1e-4);
}

// A white floor under a pane that reflects F and passes 1 - F of the light: E = (1 - F) + F E, so E = 1.
TEST(ReferencePanes, ReflectBetweenFloorAndPaneWhatTheyDoNotPass) {
  Scene scene =
      sceneOf({testing::grid({0, 0, 0}, 1e4f, 1), testing::flipped(testing::grid({0, 1, 0}, 1e4f, 1))});
  testing::paint(scene, 1, pane());
  const auto m = measured(scene, {0, 0.9f, 0.1f}, {0, 0, 0}, {uniform(1.0f)}, samples(256));
  EXPECT_NEAR(m.mean.g, 1.0, 4.0 * m.error.g + 2e-3);
}

}  // namespace
}  // namespace lambent::baker::reference
