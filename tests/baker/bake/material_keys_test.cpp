// Checks that every field of a material is part of the keys that decide whether a bundle is up to date, and
// whether a cached result is valid.
#include <gtest/gtest.h>

#include "baker/bake/bake.hpp"
#include "baker/bake/group_scene.hpp"
#include "tests/support/material_values.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using testing::changed;

// Makes a glossy plate of the material, with everything that a field may need to have an effect.
Scene plateOf(const gltf::Material& material) {
  Scene scene = testing::sceneOf({testing::grid({0, 0, 0}, 1.0f, 2)});
  scene.materials = {material};
  scene.textures.resize(testing::kMaterialTextures);
  scene.images.resize(testing::kMaterialTextures);
  for (std::size_t i = 0; i < testing::kMaterialTextures; ++i) {
    scene.textures[i].image = static_cast<std::int32_t>(i);
    scene.images[i].file_bytes = {std::byte(i)};
  }
  scene.brdfs.resize(1);
  scene.brdfs[0].measurements.resize(1);
  return scene;
}

TEST(MaterialKeys, EveryFieldPutsABundleOutOfDate) {
  const gltf::Material plain = testing::materialWithEverything();
  const std::uint64_t before = sceneDigest(plateOf(plain));
  gltf::forEachMaterialField([&](const auto& field) {
    EXPECT_NE(sceneDigest(plateOf(changed(plain, field))), before) << field.name;
  });
}

// If rows of the table move, or values are hashed in another form, every bundle is out of date.
TEST(MaterialKeys, DigestsOfScenesStayAsTheyWere) {
  EXPECT_EQ(sceneDigest(plateOf(testing::materialWithEverything())), 0xacfbf1713277b284ull);
}

GroupKeys keysOf(const gltf::Material& material) {
  const Scene scene = plateOf(material);
  GroupGeometry geometry;
  geometry.positions.resize(3), geometry.triangles.resize(1);
  DrawGeometry draw;
  draw.material = 0, draw.kind = SampleKind::Glossy;
  geometry.draws = {draw};
  const PlannedLight lamp{.kind = PlannedLight::Kind::Material, .index = 0};
  return groupKeys(scene, geometry, {&lamp, 1}, {}, {});
}

TEST(MaterialKeys, EveryFieldThatABakeDependsOnChangesTheKeysOfItsResults) {
  using Part = gltf::MaterialPart;
  gltf::forEachMaterialField([&](const auto& field) {
    const std::string name(field.name);
    gltf::Material plain = testing::materialWithEverything();
    // Only panes have a use for these, and their rays depend on how they reflect, too.
    const bool of_panes =
        name == "transmission_texture" || name == "thickness_m" || name.starts_with("attenuation");
    plain.transmission = of_panes ? 0.5f : 0.0f;
    const GroupKeys before = keysOf(plain), keys = keysOf(changed(plain, field));
    // Strengths of lamps, names and bumps are applied at run time.
    const bool baked =
        name != "emissive" && name != "normal_scale" && name != "normal_texture" && name != "name";
    EXPECT_EQ(keys.cells != before.cells, baked) << name;
    // Rays are traced again only if other rays are blocked, or a lamp changes.
    const bool stops =
        field.part == Part::Opacity || name == "emissive_texture" || name.starts_with("base_color");
    EXPECT_EQ(keys.rays != before.rays, stops) << name;
    if (field.part == Part::Color || field.part == Part::Reflection) {
      EXPECT_NE(keys.proxy, before.proxy) << name;
    }
  });
}

}  // namespace
}  // namespace lambent::baker
