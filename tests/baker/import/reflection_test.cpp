// Tests materials: emission, textures and normal maps, metal and roughness, the related extensions, and
// measured BRDFs; and lights without surfaces.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "baker/import/image.hpp"
#include "baker/import/measured_brdf.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using testing::GltfWriter;
using testing::imported;
using testing::oneTriangle;
using testing::refusal;
using testing::TemporaryFolder;

GltfWriter withMaterials(const TemporaryFolder& folder, const json& materials) {
  GltfWriter writer = oneTriangle();
  writer.primitive()["attributes"]["NORMAL"] =
      writer.add<float>("VEC3", 5126, {0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  writer.primitive()["attributes"]["TANGENT"] =
      writer.add<float>("VEC4", 5126, {2, 0, 0, 0.5f, 0, 1, 0, -1, 1, 0, 0, 1}, 4);
  writer.primitive()["attributes"]["TEXCOORD_0"] = writer.add<float>("VEC2", 5126, {0, 0, 1, 0, 0, 1}, 2);
  writer.primitive()["material"] = 0;
  writer.json["materials"] = materials;
  writer.json["textures"] = json::parse(R"([{"source":0},{"source":1},{"source":2},{"source":3}])");
  writer.json["images"] =
      json::parse(R"([{"uri":"a.png"},{"uri":"b.png"},{"uri":"c.png"},{"uri":"d.webp"}])");
  for (const char* name : {"a.png", "b.png", "c.png"}) folder.write(name, testing::kPngFile);
  folder.write("d.webp", "RIFF....WEBP");
  return writer;
}
GltfWriter withOneMaterial(const TemporaryFolder& folder, const char* material) {
  return withMaterials(folder, json::array({json::parse(material)}));
}

constexpr const char* kEverything = R"({"pbrMetallicRoughness":{"metallicFactor":0.5,"roughnessFactor":0.25,
    "metallicRoughnessTexture":{"index":0,"texCoord":1}},
  "extensions":{"KHR_materials_ior":{"ior":2.5},
    "KHR_materials_specular":{"specularFactor":0.75,"specularColorFactor":[1,2,0.5],"specularTexture":{"index":1},
      "specularColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"scale":[3,4]}}}},
    "KHR_materials_anisotropy":{"anisotropyStrength":0.5,"anisotropyRotation":1.25,"anisotropyTexture":{"index":2}}}})";

TEST(Reflection, OfEveryKindIsReadWithItsTextures) {
  TemporaryFolder folder;
  const Scene scene = imported(withOneMaterial(folder, kEverything), folder);
  const gltf::Material& m = scene.materials.at(0);
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.metallic_roughness_texture.texcoord, 1u);
  EXPECT_EQ(m.ior, 2.5f);
  EXPECT_EQ(m.specular, 0.75f);
  EXPECT_EQ(m.specular_color, glm::vec3(1.0f, 2.0f, 0.5f));
  EXPECT_EQ(m.specular_color_texture.scale, glm::vec2(3.0f, 4.0f));
  EXPECT_EQ(m.anisotropy, 0.5f);
  EXPECT_EQ(m.anisotropy_rotation_rad, 1.25f);
  const auto imageOf = [&](const gltf::TextureRef& ref) {
    return scene.images
        .at(static_cast<std::size_t>(scene.textures.at(static_cast<std::size_t>(ref.texture)).image))
        .name;
  };
  EXPECT_EQ(imageOf(m.metallic_roughness_texture), "a.png");
  EXPECT_EQ(imageOf(m.specular_texture), "b.png");
  EXPECT_EQ(imageOf(m.specular_color_texture), "a.png");
  EXPECT_EQ(imageOf(m.anisotropy_texture), "c.png");
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_FALSE(m.isDiffuse());
}

TEST(Reflection, OfPanesIsReadWithWhatTheyTransmitAndAbsorb) {
  TemporaryFolder folder;
  const Scene scene = imported(withOneMaterial(folder, R"({"pbrMetallicRoughness":{"metallicFactor":0},
    "extensions":{"KHR_materials_transmission":{"transmissionFactor":0.75,"transmissionTexture":{"index":1}},
      "KHR_materials_volume":{"thicknessFactor":0.5,"attenuationDistance":2,"attenuationColor":[0.25,0.5,1]}}})"),
                               folder);
  const gltf::Material& m = scene.materials.at(0);
  EXPECT_EQ(m.transmission, 0.75f);
  EXPECT_GE(m.transmission_texture.texture, 0);
  EXPECT_EQ(m.thickness_m, 0.5f);
  EXPECT_EQ(m.attenuation_distance_m, 2.0f);
  EXPECT_EQ(m.attenuation_color, glm::vec3(0.25f, 0.5f, 1.0f));
  EXPECT_FLOAT_EQ(m.passedStraightOn(), 0.75f * 0.96f);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Reflection, IsWhatGltfSaysWhereTheFileSaysNothing) {
  TemporaryFolder folder;
  const gltf::Material m = imported(withOneMaterial(folder, R"({"extensions":{"KHR_materials_ior":{},
      "KHR_materials_specular":{},"KHR_materials_anisotropy":{}}})"),
                                    folder)
                               .materials.at(0);
  EXPECT_EQ(m.metallic, 1.0f);
  EXPECT_EQ(m.roughness, 1.0f);
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.specular, 1.0f);
  EXPECT_EQ(m.specular_color, glm::vec3(1.0f));
  EXPECT_EQ(m.anisotropy, 0.0f);
  EXPECT_EQ(m.brdf, -1);
}

TEST(Reflection, TexturesThatCouldChangeNothingStayOut) {
  TemporaryFolder folder;
  json material = json::parse(kEverything);
  material["pbrMetallicRoughness"]["metallicFactor"] = 0;
  material["extensions"]["KHR_materials_specular"]["specularFactor"] = 0;
  material["extensions"]["KHR_materials_anisotropy"]["anisotropyStrength"] = 0;
  const Scene scene = imported(withMaterials(folder, json::array({material})), folder);
  EXPECT_TRUE(scene.images.empty());
  EXPECT_TRUE(scene.materials.at(0).isDiffuse());
}

TEST(Reflection, KeepsTangentsWhereTheLobeIsNotRound) {
  TemporaryFolder folder;
  const auto tangents = [&](const char* material) {
    return imported(withOneMaterial(folder, material), folder)
        .meshes.at(0)
        .primitives.at(0)
        .mesh.tangents.size();
  };
  EXPECT_EQ(tangents(R"({"extensions":{"KHR_materials_anisotropy":{"anisotropyStrength":0.5}}})"), 3u);
  EXPECT_EQ(tangents(R"({"extensions":{"KHR_materials_anisotropy":{"anisotropyStrength":0}}})"), 0u);
  EXPECT_EQ(tangents(R"({"extensions":{"KHR_materials_anisotropy":{"anisotropyStrength":0.5},
      "KHR_materials_unlit":{}}})"),
            0u);
}

TEST(Reflection, FactorsOutOfTheirRangeAreClampedWithOneWarning) {
  TemporaryFolder folder;
  const auto mended = [&](const char* material, const char* words) {
    const Scene scene = imported(withOneMaterial(folder, material), folder);
    EXPECT_EQ(scene.warnings.size(), 1u) << material;
    EXPECT_NE(scene.warnings.at(0).find("material 0"), std::string::npos) << scene.warnings[0];
    EXPECT_NE(scene.warnings[0].find(words), std::string::npos) << scene.warnings[0];
    return scene.materials.at(0);
  };
  const auto pbr = [](const char* inner) {
    return std::string(R"({"pbrMetallicRoughness":{)") + inner + "}}";
  };
  const auto extension = [](const char* name, const char* inner) {
    return std::string(R"({"extensions":{"KHR_materials_)") + name + R"(":{)" + inner + "}}}";
  };
  EXPECT_EQ(mended(pbr(R"("roughnessFactor":1.5)").c_str(), "roughnessFactor").roughness, 1.0f);
  EXPECT_EQ(mended(pbr(R"("metallicFactor":-1)").c_str(), "metallicFactor").metallic, 0.0f);
  EXPECT_EQ(mended(pbr(R"("baseColorFactor":[0.5,1,0])").c_str(), "no alpha").base_color,
            glm::vec4(0.5f, 1.0f, 0.0f, 1.0f));
  EXPECT_EQ(mended(pbr(R"("baseColorFactor":[0.5,2,-1,1])").c_str(), "counts as").base_color,
            glm::vec4(0.5f, 1.0f, 0.0f, 1.0f));
  EXPECT_EQ(mended(extension("ior", R"("ior":0.5)").c_str(), "ior is 0.5").ior, 1.0f);
  EXPECT_EQ(mended(extension("ior", R"("ior":1e60)").c_str(), "ior is 1e+60").ior, 1.5f);
  EXPECT_EQ(mended(extension("specular", R"("specularFactor":2)").c_str(), "specularFactor").specular, 1.0f);
  EXPECT_EQ(
      mended(extension("specular", R"("specularColorFactor":[1,-1,1])").c_str(), "counts as").specular_color,
      glm::vec3(1.0f, 0.0f, 1.0f));
  EXPECT_EQ(mended(extension("specular", R"("specularColorFactor":[1,1])").c_str(), "3 finite numbers")
                .specular_color,
            glm::vec3(1.0f));
  EXPECT_EQ(mended(extension("anisotropy", R"("anisotropyStrength":1.5)").c_str(), "counts as 1").anisotropy,
            1.0f);
  EXPECT_EQ(mended(extension("anisotropy", R"("anisotropyTexture":{})").c_str(), "has no index").anisotropy,
            0.0f);
  EXPECT_EQ(mended(R"({"extensions":{"KHR_materials_ior":3}})", "is not an object").ior, 1.5f);
  EXPECT_EQ(mended(R"({"alphaMode":"mask"})", "alphaMode").alpha_mode, gltf::AlphaMode::Mask);
  EXPECT_TRUE(mended(R"({"doubleSided":1})", "doubleSided").double_sided);
}

TEST(Reflection, TexturesThatDoNotExistAndMeasuredBrdfsWithoutANameAreRefused) {
  TemporaryFolder folder;
  const auto refused = [&](const char* material, const char* words) {
    const std::string line = refusal(withOneMaterial(folder, material), folder);
    EXPECT_NE(line.find(words), std::string::npos) << line;
    EXPECT_NE(line.find("material 0"), std::string::npos) << line;
  };
  refused(R"({"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":4}}})", "metallicRoughnessTexture");
  refused(R"({"extensions":{"KHR_materials_specular":{"specularTexture":{"index":9}}}})", "specularTexture");
  refused(R"({"extras":{"lambent":{"brdf":7}}})", "brdf is not a string");
}

TEST(Reflection, OfSpecularGlossinessHasTheSameLobes) {
  TemporaryFolder folder;
  const auto converted = [&](const char* inner) {
    const std::string material =
        std::string(R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{)") + inner + "}}}";
    GltfWriter writer = withOneMaterial(folder, material.c_str());
    writer.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    return imported(writer, folder);
  };
  const Scene plain = converted(
      R"("diffuseFactor":[0.2,0.4,0.6,1],"specularFactor":[0.04,0.02,0.04],"glossinessFactor":0.75)");
  EXPECT_TRUE(plain.warnings.empty());
  const gltf::Material& m = plain.materials.at(0);
  EXPECT_EQ(m.base_color, glm::vec4(0.2f, 0.4f, 0.6f, 1.0f));
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_NEAR(m.reflectance(), 0.04f, 1e-6f);
  EXPECT_EQ(m.specular_color, glm::vec3(1.0f, 0.5f, 1.0f));
  const Scene metal = converted(R"("diffuseFactor":[0,0,0,1],"specularFactor":[0.9,0.8,0.1])");
  EXPECT_EQ(metal.materials.at(0).metallic, 1.0f);
  EXPECT_EQ(metal.materials[0].base_color, glm::vec4(0.9f, 0.8f, 0.1f, 1.0f));
  EXPECT_EQ(metal.materials[0].roughness, 0.0f);
  // The texture has no alpha, so its glossiness is 1.
  const Scene textured = converted(R"("glossinessFactor":0.25,"specularGlossinessTexture":{"index":1})");
  const auto roughness =
      static_cast<std::size_t>(textured.materials.at(0).metallic_roughness_texture.texture);
  const auto image =
      decodeImage(textured.images.at(static_cast<std::size_t>(textured.textures.at(roughness).image)));
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->rgba, (std::vector<std::uint8_t>{0, 191, 0, 255}));
}

// The file has two measurements: a white one of value 2, and a black one.
constexpr const char* kWhite =
    "# num wls\r\n4\r\n\r\n# wls\r\n400 500\r\n600 700\r\n\r\n# values\r\n\r\n"
    "0.5 0.25 0.75 -1.5 2 2 2 2\r\n0 0 1.5708 3 0 0 0 0\r\n";

TEST(MeasuredBrdf, ColoursAreThoseOfTheSpectrum) {
  TemporaryFolder folder;
  const auto colorOf = [&](const char* values) {
    const std::string text = std::string("7\n400 450 500 550 600 650 700\n0 0 0 0 ") + values + "\n";
    const auto measured = readMeasuredBrdf(folder.write("color.brdf", text));
    EXPECT_TRUE(measured) << (measured ? "" : measured.error().line());
    return measured ? measured->measurements.at(0).value : glm::vec3(0.0f);
  };
  const glm::vec3 red = colorOf("0 0 0 0 1 1 1"), green = colorOf("0 0 0.5 1 0 0 0"),
                  blue = colorOf("1 1 0.5 0 0 0 0");
  EXPECT_GT(red.r, 5.0f * std::max(red.g, red.b));
  EXPECT_GT(green.g, 2.0f * std::max(green.r, green.b));
  EXPECT_GT(blue.b, 5.0f * std::max(blue.r, blue.g));
  // None of them takes light away, though Rec.709 has no such green.
  for (const glm::vec3& color : {red, green, blue}) EXPECT_GE(std::min({color.r, color.g, color.b}), 0.0f);
}

TEST(MeasuredBrdf, FilesThatAreBrokenAreRefusedByLine) {
  TemporaryFolder folder;
  const auto refused = [&](const std::string& text, const char* words) {
    const auto measured = readMeasuredBrdf(folder.write("broken.brdf", text));
    ASSERT_FALSE(measured) << words;
    EXPECT_NE(measured.error().line().find(words), std::string::npos) << measured.error().line();
    EXPECT_NE(measured.error().line().find("broken.brdf"), std::string::npos);
    EXPECT_FALSE(measured.error().hint.empty());
  };
  const std::string head = "2\n400 700\n";
  refused("", "ends where the number of wavelengths");
  refused("0\n", "0 wavelengths");
  refused("2.5\n1 2\n", "2.5 wavelengths");
  refused("1e9\n", "wavelengths");
  refused("2\n700 400\n", "line 2: wavelengths do not rise");
  refused("2\n400 410\n0 0 0 0 1 1\n", "visible range");
  refused("2\n4000 7000\n0 0 0 0 1 1\n", "visible range");
  refused(head, "holds no measurement");
  refused(head + "0 0 0\n", "ends where phi_s");
  refused(head + "0 0 0 0 1\n", "ends where a value of the spectrum");
  refused(head + "0 0 0 0 1 nan\n", "line 3");
  refused(head + "0 0 0 0 1 inf\n", "line 3");
  refused(head + "\n0 0 0 zero 1 1\n", "line 4: phi_s is not a finite number");
  refused(head + "0 0 0 0 1 1x\n", "line 3");
  refused(head + "1.6 0 0 0 1 1\n", "theta_i is 1.6");
  refused(head + "0 0 -0.1 0 1 1\n", "theta_s is -0.1");
}

TEST(MeasuredBrdf, MaterialsThatNameOneFileShareIt) {
  TemporaryFolder folder;
  folder.write("paints/white 1.brdf", kWhite);
  folder.write("black.brdf", "1\n550\n0 0 0 0 0\n");
  const json materials = json::parse(R"([{"extras":{"lambent":{"brdf":"paints/white%201.brdf"}}},{"extras":7},
      {"extras":{"lambent":{"brdf":"./paints/../paints/white%201.brdf"}}},{"extras":{"lambent":{"brdf":"black.brdf"}}}])");
  const Scene scene = imported(withMaterials(folder, materials), folder);
  ASSERT_EQ(scene.brdfs.size(), 2u);
  EXPECT_EQ(scene.brdfs[0].name, "white 1.brdf");
  EXPECT_EQ(scene.brdfs[1].name, "black.brdf");
  const std::vector<std::int32_t> expected = {0, -1, 0, 1};
  ASSERT_EQ(scene.materials.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(scene.materials[i].brdf, expected[i]) << i;
  EXPECT_FALSE(scene.materials[0].isDiffuse());
}

TEST(MeasuredBrdf, ThatASceneCannotUseNamesFileAndMaterial) {
  TemporaryFolder folder;
  folder.write("broken.brdf", "2\n");
  const auto refused = [&](const char* file, const char* words) {
    const std::string material = std::string(R"({"extras":{"lambent":{"brdf":")") + file + "\"}}}";
    const std::string line = refusal(withOneMaterial(folder, material.c_str()), folder);
    for (const char* part : {words, "scene.gltf", "material 0"})
      EXPECT_NE(line.find(part), std::string::npos) << line;
  };
  refused("none.brdf", "none.brdf): no such file");
  refused("broken.brdf", "broken.brdf): ends where");
  refused("../elsewhere.brdf", "lies outside");
  refused("http://example.com/a.brdf", "not a file beside the scene");
}

TEST(Materials, ThatShineByATextureThatCannotBeReadDoNotShine) {
  TemporaryFolder folder;
  for (const char* texture : {R"({"index":3})", R"({"index":0,"texCoord":2})"}) {
    const std::string material =
        std::string(R"({"emissiveFactor":[1,1,1],"emissiveTexture":)") + texture + "}";
    const Scene scene = imported(withOneMaterial(folder, material.c_str()), folder);
    EXPECT_EQ(scene.materials.at(0).emissive, glm::vec3(0.0f));
    EXPECT_EQ(scene.warnings.size(), 2u) << texture;  // what was left out, and what follows
  }
}

TEST(Materials, KeepTheTransformOfEachTexture) {
  TemporaryFolder folder;
  const Scene scene = imported(withOneMaterial(folder, R"({
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
  GltfWriter writer = withOneMaterial(folder, R"({"normalTexture":{"index":0}})");
  writer.primitive()["attributes"]["TANGENT"] =
      writer.add<float>("VEC4", 5126, {2, 0, 0, 0.5f, 0, 1, 0, -1, 0, 0, 0, 1}, 4);
  const Scene bumped = imported(writer, folder);
  const auto& tangents = bumped.meshes.at(0).primitives.at(0).mesh.tangents;
  ASSERT_EQ(tangents.size(), 3u);
  EXPECT_EQ(tangents[0], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(tangents[1], glm::vec4(0, 1, 0, -1));
  EXPECT_NEAR(glm::length(glm::vec3(tangents[2])), 1.0f, 1e-6f);  // it had none; any in the surface
  EXPECT_EQ(tangents[2].z, 0.0f);
  EXPECT_EQ(bumped.warnings.size(), 1u);
  const Scene plain = imported(withOneMaterial(folder, "{}"), folder);
  EXPECT_TRUE(plain.meshes.at(0).primitives.at(0).mesh.tangents.empty());
  const Scene unread =
      imported(withOneMaterial(folder, R"({"normalTexture":{"index":0,"texCoord":3}})"), folder);
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
