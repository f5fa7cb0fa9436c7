// Checks that every field of a material is part of the digest that decides whether a checkpoint can be
// resumed.
#include <gtest/gtest.h>

#include "reference/reference.hpp"
#include "tests/support/material_values.hpp"

namespace lambent::baker::reference {
namespace {

std::uint64_t digestWith(const gltf::Material& material) {
  Scene scene;
  scene.materials = {material};
  return digestOf(scene, {}, {}, {}, {});
}

TEST(ReferenceDigest, ChangesWithEveryFieldOfAMaterialButItsName) {
  const gltf::Material plain = testing::materialWithEverything();
  gltf::forEachMaterialField([&](const auto& field) {
    EXPECT_EQ(digestWith(testing::changed(plain, field)) != digestWith(plain), field.name != "name")
        << field.name;
  });
}

}  // namespace
}  // namespace lambent::baker::reference
