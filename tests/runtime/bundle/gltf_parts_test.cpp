// Tests that materials, lights and animations are read back as they were written, and that what no viewer
// could use is refused.
#include <gtest/gtest.h>

#include "runtime/bundle/description_json.hpp"
#include "runtime/bundle/material_fields.hpp"
#include "tests/runtime/bundle/bundle_file.hpp"
#include "tests/support/material_values.hpp"

namespace lambent::bundle {
namespace {

using gltf::AnimationChannel;

using GltfParts = BundleFile;

Description empty() {
  Description d;
  d.generator = {"lambent", "0.1.0", "x86-64-v3", {}};
  return d;
}

// Writes it alone, without the tables that the bundle's reader requires.
TEST(MaterialJson, NamesMeasuredBrdfsByNumberInExtras) {
  gltf::Material paint;
  paint.brdf = 3;
  std::set<std::string> used;
  const Json json = materialJson(paint, used);
  EXPECT_EQ(json["extras"]["lambent"]["brdf"], 3);
  EXPECT_TRUE(used.empty());
  EXPECT_EQ(readMaterial(Field(json, "material"), 0).brdf, 3);
}

TEST(MaterialJson, RefusesFactorsThatAreNone) {
  const auto refused = [](auto spoil, const char* words) {
    gltf::Material material;
    spoil(material);
    std::set<std::string> used;
    const Json json = materialJson(material, used);
    try {
      readMaterial(Field(json, "material"), 0);
      ADD_FAILURE() << words;
    } catch (const JsonFault& fault) {
      EXPECT_NE(std::string(fault.what()).find(words), std::string::npos) << fault.what();
    }
  };
  refused([](gltf::Material& m) { m.metallic = 1.5f; }, "metallicFactor is not from 0 to 1");
  refused([](gltf::Material& m) { m.roughness = -0.5f; }, "roughnessFactor is not from 0 to 1");
  refused([](gltf::Material& m) { m.ior = 0.5f; }, "ior is neither");
  refused([](gltf::Material& m) { m.specular = 2.0f; }, "specularFactor is not from 0 to 1");
  refused([](gltf::Material& m) { m.specular_color.y = -1.0f; }, "specularColorFactor is negative");
  refused([](gltf::Material& m) { m.anisotropy = 3.0f; }, "anisotropyStrength is not from 0 to 1");
  refused([](gltf::Material& m) { m.anisotropy_rotation_rad = std::nanf(""); }, "anisotropyRotation");
}

TEST_F(GltfParts, LightsComeBackWithTheirNodes) {
  Description d = empty();
  using Type = gltf::Light::Type;
  d.lights = {{.name = "sun", .type = Type::Directional, .color = {1.0f, 0.5f, 0.25f}, .intensity = 3.0f},
              {.name = "bulb", .intensity = 100.0f, .range_m = 7.0f},
              {.name = "", .type = Type::Spot, .inner_cone_rad = 0.2f, .outer_cone_rad = 0.3f}};
  d.nodes.resize(2);
  d.nodes[1].light = 2;
  d.roots = {0, 1};
  const auto reader = through({d, {}});
  ASSERT_TRUE(reader) << reader.error().line();
  const Description& back = reader->description();
  ASSERT_EQ(back.lights.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back.lights[i].name, d.lights[i].name);
    EXPECT_EQ(back.lights[i].type, d.lights[i].type);
    EXPECT_EQ(back.lights[i].color, d.lights[i].color);
    EXPECT_EQ(back.lights[i].intensity, d.lights[i].intensity);
    EXPECT_EQ(back.lights[i].range_m, d.lights[i].range_m);
  }
  EXPECT_EQ(back.lights[2].outer_cone_rad, 0.3f);
  EXPECT_EQ(back.nodes[0].light, -1);
  EXPECT_EQ(back.nodes[1].light, 2);
}

Description moving() {
  Description d = empty();
  d.nodes.resize(2);
  d.nodes[1].trs = gltf::Trs{{1, 2, 3}, glm::quat(0.5f, 0.5f, -0.5f, 0.5f), {-1, 0, 2}};
  d.nodes[1].parent_from_node = d.nodes[1].trs->matrix();
  d.roots = {0, 1};
  AnimationChannel slide{.node = 0,
                         .interpolation = AnimationChannel::Interpolation::Step,
                         .times_s = {0.0f, 0.1f, 5.0f},
                         .values = {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  AnimationChannel turn{
      .node = 1, .path = AnimationChannel::Path::Rotation, .times_s = {0.25f}, .values = {0, 0, 0, 1}};
  AnimationChannel grow{.node = 1,
                        .path = AnimationChannel::Path::Scale,
                        .interpolation = AnimationChannel::Interpolation::Cubic,
                        .times_s = {1.0f},
                        .values = {0, 0, 0, 1, 1, 1, 0, 0, 0}};
  d.animations = {{"walk", {slide, turn}}, {"", {grow}}};
  return d;
}

TEST_F(GltfParts, AnimationsKeepEveryKeyAndTheirNodesTheirParts) {
  const Description d = moving();
  const auto reader = through({d, {Blob(3)}});
  ASSERT_TRUE(reader) << reader.error().line();
  const Description& back = reader->description();
  EXPECT_EQ(back.views.size(), 3u);  // the blob, and one for each animation
  ASSERT_EQ(back.animations.size(), 2u);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(back.animations[a].name, d.animations[a].name);
    ASSERT_EQ(back.animations[a].channels.size(), d.animations[a].channels.size());
    for (std::size_t c = 0; c < d.animations[a].channels.size(); ++c) {
      const AnimationChannel& found = back.animations[a].channels[c];
      const AnimationChannel& expected = d.animations[a].channels[c];
      EXPECT_EQ(found.node, expected.node);
      EXPECT_EQ(found.path, expected.path);
      EXPECT_EQ(found.interpolation, expected.interpolation);
      EXPECT_EQ(found.times_s, expected.times_s);
      EXPECT_EQ(found.values, expected.values);
    }
  }
  EXPECT_TRUE(back.nodes[0].animated);
  EXPECT_EQ(back.nodes[0].trs, gltf::Trs{});
  EXPECT_TRUE(back.nodes[1].animated);
  EXPECT_EQ(back.nodes[1].trs, d.nodes[1].trs);
  EXPECT_EQ(back.nodes[1].parent_from_node, d.nodes[1].parent_from_node);
  EXPECT_TRUE(reader->checkAll());
}

TEST_F(GltfParts, ThatNobodyCouldUseAreRefusedByName) {
  const auto refused = [&](auto spoil, const char* words) {
    Description d = moving();
    d.lights.resize(1);
    spoil(d);
    BundleFile::refused({d, {}}, words);
  };
  refused([](Description& d) { d.animations[0].channels[0].node = 2; }, "target.node");
  refused([](Description& d) { d.animations[0].channels[0].times_s[1] = 9.0f; },
          "animation 0 make no motion");
  refused([](Description& d) { d.animations[1].channels[0].values[4] = std::nanf(""); },
          "animation 1 make no motion");
  refused([](Description& d) { d.animations[0].channels[1].values.resize(8); }, "2 values for 1 keys");
  refused([](Description& d) { d.nodes[0].parent_from_node[3].x = 1.0f; }, "has a matrix");
  refused([](Description& d) { d.nodes[1].trs->rotation.w = 5.0f; }, "unit quaternion");
  refused([](Description& d) { d.nodes[0].light = 1; }, "light");
  refused([](Description& d) { d.lights[0].intensity = -1.0f; }, "intensity is negative");
  refused([](Description& d) { d.lights[0].color.y = -1.0f; }, "color is negative");
  refused(
      [](Description& d) {
        d.lights[0] = {.name = "", .type = gltf::Light::Type::Spot, .inner_cone_rad = 1.0f};
      },
      "spot");
}

// Checks that every field of a material survives JSON, and the copy between the material and its live values.

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
