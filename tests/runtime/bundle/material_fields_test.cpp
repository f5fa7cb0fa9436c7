// Checks that every field of a material survives JSON, and the copy between the material and its live values.
#include "runtime/bundle/material_fields.hpp"

#include <gtest/gtest.h>

#include "runtime/bundle/description_json.hpp"
#include "tests/support/material_values.hpp"

namespace lambent::bundle {
namespace {

using testing::changed;
using testing::materialWithEverything;

TEST(MaterialFields, EveryFieldChangesTheJsonAndComesBackFromIt) {
  const gltf::Material plain = materialWithEverything();
  std::set<std::string> used;
  const Json before = materialJson(plain, used);
  gltf::forEachMaterialField([&](const auto& field) {
    const gltf::Material other = changed(plain, field);
    const Json json = materialJson(other, used);
    EXPECT_NE(json, before) << field.name;
    const gltf::Material read =
        readMaterial(Field(Json::parse(json.dump()), "material"), testing::kMaterialTextures);
    EXPECT_EQ(read.*field.member, other.*field.member) << field.name;
    // Nothing else may have changed with it.
    std::size_t differ = 0;
    gltf::forEachMaterialField([&](const auto& each) { differ += read.*each.member != plain.*each.member; });
    EXPECT_EQ(differ, 1u) << field.name;
  });
}

TEST(MaterialFields, EveryLiveValueIsReadFromItsFieldAndChangesIt) {
  const gltf::Material plain = materialWithEverything();
  const gltf::MaterialFactors factors = gltf::factorsOf(plain);
  gltf::forEachMaterialField([&](const auto& each) {
    EXPECT_EQ(gltf::withFactors(plain, factors).*each.member, plain.*each.member) << each.name;
  });
  gltf::forEachLiveValue([&](const auto& field, const auto& live) {
    gltf::MaterialFactors other = factors;
    testing::change(other.*live.factor);
    const gltf::Material material = gltf::withFactors(plain, other);
    gltf::forEachMaterialField([&](const auto& each) {
      EXPECT_EQ(material.*each.member != plain.*each.member, each.name == field.name)
          << live.name << " in " << each.name;
    });
  });
}

}  // namespace
}  // namespace lambent::bundle
