// Tests emission, textures and normal maps of materials, and lights without surfaces.
#include <numbers>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using testing::GltfWriter;
using testing::imported;
using testing::oneTriangle;
using testing::TemporaryFolder;

// Makes a triangle with texture coordinates, two textures and this material.
GltfWriter withMaterial(const TemporaryFolder& folder, const char* material) {
  GltfWriter writer = oneTriangle();
  writer.primitive()["attributes"]["NORMAL"] =
      writer.add<float>("VEC3", 5126, {0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  writer.primitive()["attributes"]["TEXCOORD_0"] = writer.add<float>("VEC2", 5126, {0, 0, 1, 0, 0, 1}, 2);
  writer.primitive()["attributes"]["TANGENT"] =
      writer.add<float>("VEC4", 5126, {2, 0, 0, 0.5f, 0, 1, 0, -1, 0, 0, 0, 1}, 4);
  writer.primitive()["material"] = 0;
  writer.json["materials"] = json::array({json::parse(material)});
  writer.json["textures"] = json::parse(R"([{"source":0},{"source":1},{"source":2}])");
  writer.json["images"] = json::parse(R"([{"uri":"a.png"},{"uri":"b.png"},{"uri":"c.webp"}])");
  folder.write("a.png", testing::kPngFile);
  folder.write("b.png", testing::kPngFile);
  folder.write("c.webp", "RIFF....WEBP");
  return writer;
}

TEST(Materials, ThatShineByATextureThatCannotBeReadDoNotShine) {
  TemporaryFolder folder;
  for (const char* texture : {R"({"index":2})", R"({"index":0,"texCoord":2})"}) {
    const std::string material =
        std::string(R"({"emissiveFactor":[1,1,1],"emissiveTexture":)") + texture + "}";
    const Scene scene = imported(withMaterial(folder, material.c_str()), folder);
    EXPECT_EQ(scene.materials.at(0).emissive, glm::vec3(0.0f));
    EXPECT_EQ(scene.warnings.size(), 2u) << texture;  // what was left out, and what follows
  }
}

TEST(Materials, KeepTheTransformOfEachTexture) {
  TemporaryFolder folder;
  const Scene scene = imported(withMaterial(folder, R"({
      "pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1,"extensions":{"KHR_texture_transform":
        {"offset":[0.25,0.5],"scale":[2,3],"rotation":1.5707963,"texCoord":0}}}},
      "normalTexture":{"index":0,"scale":0.5,"extensions":{"KHR_texture_transform":{"scale":[4,4]}}}})"),
                               folder);
  const gltf::Material& material = scene.materials.at(0);
  EXPECT_EQ(material.base_color_texture.texcoord, 0u);  // the extension's word counts
  // R(90 deg) turns (2, 0) to (0, -2) as the extension writes its matrix.
  const glm::vec2 uv = material.base_color_texture.apply({1.0f, 0.0f});
  EXPECT_NEAR(uv.x, 0.25f, 1e-6f);
  EXPECT_NEAR(uv.y, -1.5f, 1e-6f);
  EXPECT_EQ(material.normal_texture.scale, glm::vec2(4.0f));
  EXPECT_EQ(material.normal_scale, 0.5f);
  EXPECT_EQ(material.normal_texture.texture, material.base_color_texture.texture);  // one texture, two uses
}

TEST(Materials, WithANormalTextureKeepUnitTangentsAndOthersNone) {
  TemporaryFolder folder;
  const Scene bumped = imported(withMaterial(folder, R"({"normalTexture":{"index":0}})"), folder);
  const auto& tangents = bumped.meshes.at(0).primitives.at(0).mesh.tangents;
  ASSERT_EQ(tangents.size(), 3u);
  EXPECT_EQ(tangents[0], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(tangents[1], glm::vec4(0, 1, 0, -1));
  EXPECT_NEAR(glm::length(glm::vec3(tangents[2])), 1.0f, 1e-6f);  // it had none; any in the surface
  EXPECT_EQ(tangents[2].z, 0.0f);
  EXPECT_EQ(bumped.warnings.size(), 1u);
  const Scene plain = imported(withMaterial(folder, "{}"), folder);
  EXPECT_TRUE(plain.meshes.at(0).primitives.at(0).mesh.tangents.empty());
  const Scene unread =
      imported(withMaterial(folder, R"({"normalTexture":{"index":0,"texCoord":3}})"), folder);
  EXPECT_TRUE(unread.meshes.at(0).primitives.at(0).mesh.tangents.empty());
  EXPECT_EQ(unread.materials[0].normal_texture.texture, -1);
}

TEST(Lights, OfAllTypesAreReadWithTheirNodes) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["extensionsRequired"] = {"KHR_lights_punctual"};
  writer.json["extensions"]["KHR_lights_punctual"]["lights"] = json::parse(R"([
      {"type":"directional","color":[1,0.5,0.25],"intensity":3},
      {"type":"point","name":"lamp","color":[4,2,0],"intensity":10,"range":7},
      {"type":"spot","spot":{"innerConeAngle":0.2,"outerConeAngle":1.5707963267948966}}])");
  writer.json["nodes"].push_back(
      json::parse(R"({"name":"bulb","extensions":{"KHR_lights_punctual":{"light":1}}})"));
  writer.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = imported(writer, folder);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].type, gltf::Light::Type::Directional);
  EXPECT_EQ(scene.lights[0].color, glm::vec3(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(scene.lights[0].range_m, 0.0f);
  EXPECT_EQ(scene.lights[1].name, "lamp");
  EXPECT_EQ(scene.lights[1].color * scene.lights[1].intensity, glm::vec3(40.0f, 20.0f, 0.0f));
  EXPECT_LE(scene.lights[1].color.x, 1.0f);
  EXPECT_EQ(scene.lights[1].range_m, 7.0f);
  EXPECT_EQ(scene.lights[2].inner_cone_rad, 0.2f);
  EXPECT_LE(double{scene.lights[2].outer_cone_rad}, std::numbers::pi / 2);
  EXPECT_EQ(scene.nodes.at(1).light, 1);
  EXPECT_EQ(scene.nodes[0].light, -1);
}

}  // namespace
}  // namespace lambent::baker
